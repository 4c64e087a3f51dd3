import { Alert, Anchor, Button, Group, SegmentedControl, Select, Stack, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useRef, useState } from "react";
import { address } from "../../api/client";
import { useFitGreyBox } from "../../api/commands";
import { greyBoxFitQuery, greyBoxFitsQuery, greyBoxModelsQuery, jobQuery } from "../../api/queries";
import type { GreyBoxFit, GreyBoxItem } from "../../api/types";
import { overFrequency } from "../../lib/figures/band";
import { dateMinute, fixed, significant, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import type { ManeuverTabProps } from "./TimeHistoryTab";
import { WindowBar } from "./WindowBar";

const METHODS = ["OE", "FRE"] as const;

type Parameter = GreyBoxFit["parameters"][number];
type Pole = GreyBoxFit["poles"][number];

interface Model {
  model: string;
  source: string;
}

const PARAMETERS: Column<Parameter>[] = [
  { key: "name", header: "Parameter", render: (one) => one.name },
  numeric("value", "Value", (one) => withError(one.value, one.std).value),
  numeric("std", "σ", (one) => withError(one.value, one.std).error),
  numeric("bound", "σ, white noise", (one) => withError(one.value, one.bound).error),
  { key: "unit", header: "Unit", render: (one) => one.unit || "1" },
  numeric("start", "Start", (one) => significant(one.start)),
  {
    key: "prior",
    header: "Prior",
    onlyIf: (one) => one.prior_value !== null,
    render: (one) =>
      one.prior_value === null
        ? ""
        : `${significant(one.prior_value)} ± ${significant(one.prior_std, 2)}`,
  },
];

const POLES: Column<Pole>[] = [
  numeric("real", "Real part", (one) => significant(one.real_rad_s), "rad/s"),
  numeric("imag", "Imaginary part", (one) => significant(one.imag_rad_s), "rad/s"),
  numeric(
    "frequency",
    "ω",
    (one) => withError(one.frequency_rad_s, one.frequency_std_rad_s).value,
    "rad/s",
  ),
  numeric(
    "frequency_std",
    "σ",
    (one) => withError(one.frequency_rad_s, one.frequency_std_rad_s).error,
  ),
  numeric("damping", "Damping ratio", (one) => withError(one.damping, one.damping_std).value),
  numeric("damping_std", "σ", (one) => withError(one.damping, one.damping_std).error),
];

/** A grey-box model, of a file or an installed package, fitted to the maneuver. */
export function GreyBoxTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const shared = overFrequency(view, onChange);
  const [model, setModel] = useState<Model | null>(null);
  const [method, setMethod] = useState<(typeof METHODS)[number]>("OE");
  const fit = useFitGreyBox();
  const request = () => {
    if (model === null) return;
    fit.mutate(
      {
        maneuver_id: maneuver.id,
        ...model,
        method,
        low_hz: shared.window?.[0] ?? null,
        high_hz: shared.window?.[1] ?? null,
      },
      {
        onSuccess: (job) => {
          onChange({ fit: job.id });
        },
      },
    );
  };
  return (
    <div className="split">
      <Stack gap="md">
        <ModelChoice model={model} onModel={setModel} />
        <SegmentedControl
          aria-label="Method"
          data={[...METHODS]}
          value={method}
          onChange={(value) => {
            setMethod(value === "FRE" ? "FRE" : "OE");
          }}
        />
        <Button
          disabled={model === null}
          loading={fit.isPending}
          onClick={request}
          data-testid="fit-grey-box"
        >
          Fit
        </Button>
        {fit.isError && <ProblemAlert error={fit.error} />}
      </Stack>
      <Stack gap="md">
        <WindowBar
          window={shared.window}
          unit="Hz"
          onClear={() => {
            shared.onWindow(null);
          }}
          hint="The excited band. Drag over the figure to select another."
          whole="The excited band"
        />
        {view.fit !== undefined && <Fit key={view.fit} id={view.fit} shared={shared} />}
        <Fits
          maneuverId={maneuver.id}
          fit={view.fit}
          onFit={(id) => {
            onChange({ fit: id });
          }}
        />
      </Stack>
    </div>
  );
}

function ModelChoice({
  model,
  onModel,
}: {
  model: Model | null;
  onModel: (model: Model | null) => void;
}) {
  const usable = useQuery(greyBoxModelsQuery).data;
  const chooser = useRef<HTMLInputElement>(null);
  const take = async (file: File | undefined) => {
    if (file !== undefined) onModel({ model: file.name, source: await file.text() });
  };
  if (usable === undefined) return null;
  return (
    <>
      {usable.accepts_files && (
        <div
          className="drop-zone"
          onDragOver={(event) => {
            event.preventDefault();
          }}
          onDrop={(event) => {
            event.preventDefault();
            void take(event.dataTransfer.files[0]);
          }}
        >
          <input
            ref={chooser}
            type="file"
            accept=".py"
            hidden
            aria-label="File of the model"
            data-testid="grey-box-file"
            onChange={(event) => {
              void take(event.currentTarget.files?.[0]);
              event.currentTarget.value = "";
            }}
          />
          <Text size="sm">
            {model === null || model.source === ""
              ? "Drop the Python file of a model"
              : model.model}
          </Text>
          <Button mt="xs" variant="default" onClick={() => chooser.current?.click()}>
            Select file
          </Button>
        </div>
      )}
      {usable.installed.length > 0 && (
        <Select
          label="Installed model"
          clearable
          data={usable.installed.map((one) => ({
            value: one.name,
            label: `${one.name} (${one.package})`,
          }))}
          value={model?.source === "" ? model.model : null}
          onChange={(name) => {
            onModel(name === null ? null : { model: name, source: "" });
          }}
        />
      )}
      {!usable.accepts_files && usable.installed.length === 0 && (
        <Text size="sm" className="quiet">
          This server executes no files, and no package with models is installed.
        </Text>
      )}
    </>
  );
}

interface FitProps {
  id: number;
  shared: ReturnType<typeof overFrequency>;
}

function Fit({ id, shared }: FitProps) {
  const job = useQuery(jobQuery(id)).data;
  const cache = useQueryClient();
  return (
    <Section title="Fit" note={job?.title}>
      <JobWait
        id={id}
        onEnd={() => {
          void cache.invalidateQueries({ queryKey: ["grey-box-fits"] });
        }}
      />
      {job?.state === "succeeded" && <StoredFit id={id} shared={shared} />}
    </Section>
  );
}

function StoredFit({ id, shared }: FitProps) {
  return (
    <Loaded query={useQuery(greyBoxFitQuery(id))} rows={8}>
      {(found) => (
        <Stack gap="sm">
          <Text size="sm" role="status" data-testid="grey-box-fit">
            {found.sentence}
          </Text>
          {found.warnings.map((warning) => (
            <Alert key={warning} color="yellow" variant="light" title={warning} />
          ))}
          <DataTable
            label="Parameters"
            columns={PARAMETERS}
            rows={found.parameters}
            rowKey={(one) => one.name}
          />
          {found.poles.length > 0 && (
            <DataTable
              label="Poles"
              columns={POLES}
              rows={found.poles}
              rowKey={(one) => `${String(one.real_rad_s)} ${String(one.imag_rad_s)}`}
            />
          )}
          <Figure
            kind="grey-box-fit"
            title="Amplitudes of the outputs, measured and modelled"
            params={{ job_id: id }}
            {...shared}
          />
          <Group gap="md">
            <Anchor href={address(`grey-box-fits/${String(id)}`, {})} download="fit.json" size="sm">
              A, B, C, D and all results (JSON)
            </Anchor>
          </Group>
          <details>
            <summary>{found.model}</summary>
            <pre style={{ overflowX: "auto" }}>{found.source}</pre>
          </details>
        </Stack>
      )}
    </Loaded>
  );
}

interface FitsProps {
  maneuverId: number;
  fit: number | undefined;
  onFit: (id: number) => void;
}

function Fits({ maneuverId, fit, onFit }: FitsProps) {
  const fits = useQuery(greyBoxFitsQuery(maneuverId)).data ?? [];
  if (fits.length === 0) return null;
  const columns: Column<GreyBoxItem>[] = [
    {
      key: "title",
      header: "Model",
      render: (one) => (
        <Anchor
          component="button"
          size="sm"
          onClick={() => {
            onFit(one.id);
          }}
        >
          {one.title}
        </Anchor>
      ),
    },
    { key: "file", header: "File or package", render: (one) => one.model },
    { key: "method", header: "Method", render: (one) => one.method },
    numeric(
      "band",
      "Band",
      (one) => one.band_hz.map((hz) => significant(hz, 3)).join(" to "),
      "Hz",
    ),
    numeric("parameters", "Parameters", (one) => one.n_parameters),
    numeric("bic", "BIC", (one) => fixed(one.bic, 1)),
    { key: "adequacy", header: "Tests", render: (one) => one.adequacy },
    { key: "finished", header: "Fitted", render: (one) => dateMinute(one.finished_at) },
  ];
  return (
    <Section
      title="Fits of this maneuver"
      note="Of equal method and band, the lowest BIC is preferred"
    >
      <DataTable
        label="Fits of this maneuver"
        columns={columns}
        rows={fits}
        rowKey={(one) => one.id}
        isSelected={(one) => one.id === fit}
        maxHeight={320}
      />
    </Section>
  );
}
