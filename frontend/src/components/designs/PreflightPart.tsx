import { Button, Group, Select, Stack, Text, TextInput } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { useSimulatePreflight } from "../../api/commands";
import { preflightSimulationsQuery } from "../../api/queries";
import type { Design, SimulationResult, SimulatedDerivative } from "../../api/types";
import { degrees, fixed, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { AdequacyBadge } from "../runs/ModelAdequacy";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import { useControllersOf } from "../predictions/useControllersOf";

const away = (row: SimulatedDerivative) =>
  row.std_error === null || row.std_error === 0 ? null : (row.estimate - row.flown) / row.std_error;

const COLUMNS: Column<SimulatedDerivative>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  numeric("flown", "Simulated", (row) => withError(row.flown, row.std_error).value),
  numeric("estimate", "Estimated", (row) => withError(row.estimate, row.std_error).value),
  numeric("error", "σ", (row) => withError(row.estimate, row.std_error).error),
  numeric("expected", "Predicted σ", (row) => withError(row.flown, row.expected).error),
  { key: "away", header: "Error", unit: "σ", numeric: true, render: (row) => fixed(away(row), 1) },
];

type Turbulence = "none" | "light" | "moderate";

const TURBULENCE = [
  { value: "none", label: "None" },
  { value: "light", label: "Light (Dryden)" },
  { value: "moderate", label: "Moderate (Dryden)" },
];

/** Limits of the surfaces as typed [deg], [deg/s], [deg/s2]; undefined where there is none. */
interface Limits {
  position?: number | undefined;
  rate?: number | undefined;
  acceleration?: number | undefined;
  freeplay?: number | undefined;
}

const LIMITS = [
  ["position", "Deflection limit", "deg"],
  ["rate", "Rate limit", "deg/s"],
  ["acceleration", "Acceleration limit", "deg/s²"],
  ["freeplay", "Freeplay", "deg"],
] as const;

const radians = (value: number | undefined) =>
  value === undefined ? undefined : (value * Math.PI) / 180;

const ALL = "all surfaces";

const isGiven = (fields: object) => Object.values(fields).some((one) => one !== undefined);

const limitsOf = (limits: Limits) => ({
  position: radians(limits.position) ?? null,
  rate: radians(limits.rate) ?? null,
  acceleration: radians(limits.acceleration) ?? null,
  freeplay: radians(limits.freeplay) ?? 0,
  delay_s: 0,
});

/** Errors of recorded channels as typed: SI unit, SI unit, [ms], [%]. */
interface Errors {
  quantum?: number | undefined;
  limit?: number | undefined;
  skew?: number | undefined;
  dropout?: number | undefined;
}

const ERRORS = [
  ["quantum", "Quantisation", "SI"],
  ["limit", "Clipping at", "SI"],
  ["skew", "Skew", "ms"],
  ["dropout", "Dropouts", "%"],
] as const;

const errorsOf = (errors: Errors, channels: string) => ({
  channels: channels
    .split(",")
    .map((one) => one.trim())
    .filter((one) => one !== ""),
  quantum: errors.quantum ?? 0,
  limit: errors.limit ?? null,
  dropout: (errors.dropout ?? 0) / 100,
  skew_s: (errors.skew ?? 0) / 1000,
});

interface Props {
  design: Design;
  level: number;
  run: number;
}

/** Closed-loop simulation of the design with a run's model, followed by its estimation. */
export function PreflightPart({ design, level, run }: Props) {
  const known = useControllersOf(run);
  const simulations = useQuery(preflightSimulationsQuery(design.id));
  const simulate = useSimulatePreflight(design.id);
  const cache = useQueryClient();
  const [controller, setController] = useState<string | null>(null);
  const [turbulence, setTurbulence] = useState<Turbulence>("none");
  const [limits, setLimits] = useState<Record<string, Limits>>({});
  const [surface, setSurface] = useState(ALL);
  const [errors, setErrors] = useState<Errors>({});
  const [channels, setChannels] = useState("");
  const given = Object.entries(limits).filter(([, one]) => isGiven(one));
  const selected = controller ?? String(known[0]?.id ?? "");
  const law = known.find((one) => String(one.id) === selected);
  const inputs = design.specification.inputs.map((own) => own.name);
  // Inputs that are commands of the control law are no surfaces: its mixer moves those.
  const isBeforeMixer = inputs.every((name) => law?.commands.includes(name));
  const surfaces = law !== undefined && isBeforeMixer ? law.drives : inputs;
  return (
    <>
      <Section
        title="Pre-flight simulation"
        note="Model, condition, sensors and noise of the run; surfaces through their actuators. The simulated record is stored as a maneuver of flight 0 and estimated like the run"
      >
        <Stack gap="sm">
          <Group align="end">
            <Select
              label="Controller"
              w={360}
              allowDeselect={false}
              data={[
                ...known.map((one) => ({ value: String(one.id), label: one.name })),
                { value: "none", label: "None (open loop)" },
              ]}
              value={selected === "" ? "none" : selected}
              onChange={setController}
            />
            <Select
              label="Turbulence"
              w={160}
              allowDeselect={false}
              data={TURBULENCE}
              value={turbulence}
              onChange={(value) => {
                setTurbulence((value ?? "none") as Turbulence);
              }}
            />
          </Group>
          {Number(selected) > 0 && (
            <Figure
              kind="control-loop"
              height={250}
              title="Control loop, and where the excitation enters"
              params={{ controller_id: Number(selected), design_id: design.id }}
            />
          )}
          <Group align="end">
            <Select
              label="Limits of"
              w={180}
              allowDeselect={false}
              data={[ALL, ...surfaces]}
              value={surface}
              onChange={(value) => {
                setSurface(value ?? ALL);
              }}
            />
            {LIMITS.map(([key, label, unit]) => (
              <NumberField
                key={`${surface} ${key}`}
                label={label}
                unit={unit}
                placeholder="none"
                isPositive
                w={180}
                value={limits[surface]?.[key]}
                onChange={(value) => {
                  setLimits((previous) => ({
                    ...previous,
                    [surface]: { ...previous[surface], [key]: value },
                  }));
                }}
              />
            ))}
          </Group>
          {given.length > 0 && (
            <Text size="sm">
              Limits are set for {given.map(([name]) => name).join(", ")}; a surface with limits of
              its own does not have those of all surfaces.
            </Text>
          )}
          <Group align="end">
            <TextInput
              label="Sensor errors of channels"
              placeholder="all outputs"
              w={240}
              value={channels}
              onChange={(event) => {
                setChannels(event.currentTarget.value);
              }}
            />
            {ERRORS.map(([key, label, unit]) => (
              <NumberField
                key={key}
                label={label}
                unit={unit}
                placeholder="none"
                isPositive
                {...(key === "dropout" ? { max: 50 } : {})}
                w={150}
                value={errors[key]}
                onChange={(value) => {
                  setErrors((previous) => ({ ...previous, [key]: value }));
                }}
              />
            ))}
            <Button
              loading={simulate.isPending}
              data-testid="simulate-preflight"
              onClick={() => {
                const id = Number(selected);
                simulate.mutate({
                  run_id: run,
                  level,
                  controller_id: Number.isInteger(id) && id > 0 ? id : null,
                  turbulence,
                  limits: isGiven(limits[ALL] ?? {}) ? limitsOf(limits[ALL] ?? {}) : null,
                  own_limits: Object.fromEntries(
                    given
                      .filter(([name]) => name !== ALL)
                      .map(([name, own]) => [name, limitsOf(own)]),
                  ),
                  sensors: isGiven(errors) ? [errorsOf(errors, channels)] : [],
                });
              }}
            >
              Simulate flight
            </Button>
          </Group>
          {simulate.isError && <ProblemAlert error={simulate.error} />}
          {simulate.data !== undefined && (
            <JobWait
              key={simulate.data.id}
              id={simulate.data.id}
              onEnd={() =>
                void cache.invalidateQueries({
                  queryKey: preflightSimulationsQuery(design.id).queryKey,
                })
              }
            />
          )}
        </Stack>
      </Section>
      <Loaded query={simulations} rows={6}>
        {(found) =>
          found.length === 0 ? (
            <Empty title="No pre-flight simulations yet">
              A pre-flight simulation gives responses, correlations and estimates before the flight.
            </Empty>
          ) : (
            <>
              {found.map((one) => (
                <One key={one.simulation.id} result={one} />
              ))}
            </>
          )
        }
      </Loaded>
    </>
  );
}

function One({ result }: { result: SimulationResult }) {
  const { simulation, derivatives } = result;
  const off = derivatives.flatMap((row) => away(row) ?? []);
  const rms = Math.sqrt(off.reduce((sum, z) => sum + z * z, 0) / Math.max(1, off.length));
  return (
    <Section
      title={result.label}
      note={`Largest correlation between two surfaces ${fixed(result.correlation, 3)}`}
      actions={
        <Group gap="sm">
          {result.adequacy !== null && <AdequacyBadge state={result.adequacy} />}
          <Link
            to="/maneuvers/$id"
            params={{ id: simulation.maneuver_id }}
            search={{ tab: "time" }}
            className="link"
          >
            Responses
          </Link>
          <Link
            to="/maneuvers/$id"
            params={{ id: simulation.maneuver_id }}
            search={{ tab: "spectra" }}
            hash="inputs"
            className="link"
          >
            Correlation
          </Link>
          <Link to="/runs/$id" params={{ id: simulation.run_id }} className="link">
            Run {simulation.run_id}
          </Link>
        </Group>
      }
    >
      {simulation.checks !== null && <Checks checks={simulation.checks} />}
      {derivatives.length === 0 ? (
        <Text size="sm">The estimation is {result.state}.</Text>
      ) : (
        <>
          <p className="quiet">
            {off.length === 0
              ? "The record does not separate all derivatives: there are no standard errors."
              : `Root mean square error of the estimates: ${fixed(rms, 2)} standard errors.`}
            {result.adequacy === "suspect" &&
              " The run is suspect: its standard errors are wider by model error. Predicted ones are wider where the run of the model is suspect."}
          </p>
          <DataTable
            label="Simulated and estimated derivatives"
            testId="simulated-derivatives"
            columns={COLUMNS}
            rows={derivatives}
            rowKey={(row) => row.name}
            isSelected={(row) => Math.abs(away(row) ?? 0) > 3}
            maxHeight={420}
          />
        </>
      )}
    </Section>
  );
}

type LoopChecks = NonNullable<SimulationResult["simulation"]["checks"]>;
type SurfaceUse = LoopChecks["surfaces"][number];

const decibels = (gain: number | null) => (gain === null ? null : 20 * Math.log10(gain));

/** Surfaces at their limits, and margins of the loop broken at each of them. */
function Checks({ checks }: { checks: LoopChecks }) {
  const marginsOf = (row: SurfaceUse) => checks.margins.find((one) => one.surface === row.name);
  const columns: Column<SurfaceUse>[] = [
    { key: "name", header: "Surface", render: (row) => row.name },
    {
      key: "peak",
      header: "Largest deflection",
      unit: "deg",
      numeric: true,
      render: (row) => fixed(degrees(row.deflection_peak), 2),
    },
    {
      key: "limited",
      header: "Time at a limit",
      unit: "%",
      numeric: true,
      render: (row) => fixed(100 * row.limited, 1),
    },
    {
      key: "gain",
      header: "Gain margin",
      unit: "dB",
      numeric: true,
      render: (row) => fixed(decibels(marginsOf(row)?.gain ?? null), 1),
    },
    {
      key: "phase",
      header: "Phase margin",
      unit: "deg",
      numeric: true,
      render: (row) => {
        const phase = marginsOf(row)?.phase ?? null;
        return fixed(phase === null ? null : degrees(phase), 1);
      },
    },
    {
      key: "modulus",
      header: "Least distance from −1",
      numeric: true,
      render: (row) => fixed(marginsOf(row)?.modulus ?? null, 2),
    },
  ];
  return (
    <DataTable
      label="Surfaces and loop"
      testId="simulated-surfaces"
      columns={columns}
      rows={checks.surfaces}
      rowKey={(row) => row.name}
      isSelected={(row) => row.limited > 0}
    />
  );
}
