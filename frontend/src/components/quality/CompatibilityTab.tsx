import { Alert, Button, Group, List, MultiSelect, Stack, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useTakeCorrections } from "../../api/commands";
import { maneuversQuery, modalTablesQuery } from "../../api/queries";
import { storedResult } from "../../api/storedResult";
import type { Compatibility, Maneuver, SensorEstimate, SensorFault } from "../../api/types";
import { useConversion } from "../../api/units";
import { count, fixed, withError } from "../../lib/text/format";
import { integers } from "../../lib/urlState";
import { ComputedResult } from "../display/ComputedResult";
import { ConditioningSteps } from "./ConditioningSteps";
import { TAKE } from "./corrections";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import type { ManeuverTabProps } from "../maneuvers/TimeHistoryTab";

const STATES = {
  compatible: { title: "Compatible", color: "green" },
  faulty: { title: "Faults of sensors", color: "red" },
  unchecked: { title: "Cannot be checked", color: "gray" },
} as const;

/** Maneuvers of one comparison. */
const MOST = 50;

/** The sensors of maneuvers compared by kinematics: faults first, then every sensor. */
export function CompatibilityTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const tables = useQuery(modalTablesQuery(maneuver.aircraft_id));
  return (
    <Loaded query={tables} rows={8}>
      {(found) =>
        found.length > 0 ? (
          <Empty title="Not compared by kinematics">
            {maneuver.aircraft_name} has a modal table:{" "}
            <Link
              to="/maneuvers/$id"
              params={{ id: maneuver.id }}
              search={{ tab: "quality" }}
              className="link"
            >
              Quality
            </Link>{" "}
            compares its sensors with the structural modes.
          </Empty>
        ) : (
          <Stack gap="md">
            <Together
              maneuver={maneuver}
              value={view.compared ?? []}
              onChange={(ids) => {
                onChange({ compared: integers(ids) });
              }}
            />
            <ComputedResult
              options={storedResult("/api/v1/compatibility", {
                query: { maneuver_ids: [maneuver.id, ...(view.compared ?? [])].join(",") },
              })}
              rows={8}
            >
              {(report) => <Report id={maneuver.id} report={report} />}
            </ComputedResult>
          </Stack>
        )
      }
    </Loaded>
  );
}

interface TogetherProps {
  maneuver: Maneuver;
  value: number[];
  onChange: (ids: string[]) => void;
}

/** Further maneuvers of the aircraft, whose recorder has the same faults. */
function Together({ maneuver, value, onChange }: TogetherProps) {
  const campaign = useInfiniteQuery(maneuversQuery({}, "id", 200));
  const others = (campaign.data?.pages ?? [])
    .flatMap((page) => page.items)
    .filter(
      (item) =>
        item.id !== maneuver.id &&
        item.aircraft_id === maneuver.aircraft_id &&
        item.axis !== "ground",
    );
  if (campaign.isError) return <ProblemAlert error={campaign.error} />;
  if (campaign.isSuccess && others.length === 0) {
    return (
      <Text size="sm" className="quiet">
        {maneuver.aircraft_name} has no further maneuver to compare the sensors over.
      </Text>
    );
  }
  const every = others.slice(0, MOST - 1).map((item) => String(item.id));
  return (
    <Group align="end" gap="sm" wrap="nowrap">
      <MultiSelect
        style={{ flex: 1 }}
        label="Further maneuvers of the recorder"
        description="A fault of the recorder is one in all of them: together they determine it better"
        searchable
        clearable
        disabled={campaign.isPending}
        maxValues={MOST - 1}
        data-testid="compared-maneuvers"
        data={others.map((item) => ({
          value: String(item.id),
          label: `${item.label} (maneuver ${item.id})`,
        }))}
        value={value.map(String)}
        onChange={onChange}
      />
      <Button
        variant="default"
        disabled={every.length === 0 || every.every((id) => value.includes(Number(id)))}
        data-testid="compare-all"
        onClick={() => {
          onChange(every);
        }}
      >
        {every.length < others.length ? `First ${MOST}` : "All of the aircraft"}
      </Button>
    </Group>
  );
}

function Report({ id, report }: { id: number; report: Compatibility }) {
  const { title, color } = STATES[report.state];
  const band = report.band_hz;
  const unchecked = report.sensors.filter((one) => one.not_checked !== null);
  return (
    <Stack gap="md">
      <Alert
        color={color}
        variant="light"
        title={title}
        role="status"
        data-testid={`compatibility-${report.state}`}
      >
        {report.faults.length === 0 ? (
          <Text size="sm">{report.sentence}</Text>
        ) : (
          <List size="sm" spacing={4}>
            {report.faults.map((fault, index) => (
              <List.Item key={index}>
                <b>{fault.finding.sentence}</b> {fault.finding.remedy} {fault.question}
              </List.Item>
            ))}
          </List>
        )}
      </Alert>
      <Corrections id={id} faults={report.faults} />
      <Section
        title="Sensors"
        note={
          band === null
            ? "Not compared"
            : `Over ${count(report.maneuver_ids.length, "maneuver")}, each as if it were at fault alone, from ${fixed(band[0], 2)} to ${fixed(band[1], 2)} Hz; ± are standard errors, bold what exceeds four of them`
        }
      >
        <Sensors sensors={report.sensors} />
      </Section>
      {unchecked.length > 0 && (
        <Section title="Not checked">
          <List size="sm">
            {unchecked.map((one) => (
              <List.Item key={one.name}>
                {one.name}: {one.not_checked}.
              </List.Item>
            ))}
          </List>
        </Section>
      )}
    </Stack>
  );
}

/** Corrections of the faults, one click each, and those made. */
function Corrections({ id, faults }: { id: number; faults: SensorFault[] }) {
  const take = useTakeCorrections(id);
  const offers = faults.flatMap(({ finding }) => finding.correction ?? []);
  return (
    <Section
      title="Corrections"
      note="A fault of a recorder is corrected in all maneuvers of the aircraft that have the channel, also in later ones. Recorded data are not changed; undoing a correction undoes it in all"
    >
      <Stack gap="sm" align="flex-start" mb={offers.length > 0 ? "sm" : 0}>
        {offers.map((one) => (
          <Button
            key={`${one.channel} ${one.kind}`}
            variant="default"
            loading={take.isPending}
            data-testid={`correct-${one.channel}`}
            onClick={() => {
              take.mutate([{ ...one, stretches: [], is_shared: true }]);
            }}
          >
            {TAKE[one.kind]} {one.channel} in all maneuvers
          </Button>
        ))}
        {take.isError && <ProblemAlert error={take.error} />}
      </Stack>
      <ConditioningSteps id={id} />
    </Section>
  );
}

function Sensors({ sensors }: { sensors: SensorEstimate[] }) {
  const length = useConversion()("m");
  const columns: Column<SensorEstimate>[] = [
    { key: "name", header: "Sensor", render: (one) => one.name },
    { key: "kind", header: "Kind", render: (one) => one.kind || "–" },
    numeric("delay", "Delay", (one) => show(one, one.delay_s, one.delay_std_s, 0, 1e3), "ms"),
    numeric("scale", "Scale factor", (one) => show(one, one.scale, one.scale_std, 1)),
    numeric(
      "arm",
      <span title="How far the sensor is from its declared place, along a body axis">
        Lever arm
      </span>,
      (one) => show(one, one.arm_m, one.arm_std_m, 0, length.factor, one.arm_axis),
      length.name,
    ),
    numeric(
      "misfit",
      <span title="Residual relative to the noise of the sensor">Residual/noise</span>,
      (one) => fixed(one.misfit, 1),
    ),
    numeric(
      "coherence",
      <span title="With the signal predicted from all other sensors">Coherence</span>,
      (one) => fixed(one.coherence, 3),
    ),
  ];
  return (
    <DataTable
      label="Sensors"
      testId="compatibility-sensors"
      columns={columns}
      rows={sensors}
      rowKey={(one) => one.name}
    />
  );
}

/** A value with its standard error, bold where it exceeds four of them. */
function show(
  sensor: SensorEstimate,
  value: number | null,
  std: number | null,
  neutral: number,
  factor = 1,
  axis = "",
) {
  if (sensor.not_checked !== null || value === null || std === null) return "–";
  const shown = withError(factor * value, factor * std);
  const text = `${axis} ${shown.value} ± ${shown.error}`.trim();
  return Math.abs(value - neutral) > 4 * std ? <b>{text}</b> : text;
}
