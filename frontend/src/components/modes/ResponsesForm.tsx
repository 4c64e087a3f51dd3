import { Button, Group, Select, Stack, TextInput } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { useEstimateResponses, useImportResponses } from "../../api/commands";
import type { Aircraft, Job, StructureFound } from "../../api/types";
import type { ModalDataView } from "../../views";
import { JobWait } from "../jobs/JobWait";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";

const ESTIMATORS = [
  { value: "H1", label: "H1: noise on the responses" },
  { value: "H2", label: "H2: noise on the force" },
  { value: "Hv", label: "Hv: noise on both" },
] as const;
const WINDOWS = [
  { value: "hann", label: "Hann" },
  { value: "rectangular", label: "Rectangular, for blocks of one period" },
] as const;

interface Props {
  id: string;
  found: StructureFound;
  aircraft: Aircraft;
  onChange: (change: Partial<ModalDataView>) => void;
}

/** Frequency responses of an upload, or time data from which they are estimated. */
export function ResponsesForm({ id, found, aircraft, onChange }: Props) {
  const save = useImportResponses(id, aircraft.id);
  const estimate = useEstimateResponses(id, aircraft.id);
  const cache = useQueryClient();
  const isRecord = found.files.some((file) => file.has_records);
  const [name, setName] = useState("GVT");
  const [fuel, setFuel] = useState(0);
  const [units, setUnits] = useState<Record<string, string>>({});
  const [estimator, setEstimator] = useState<(typeof ESTIMATORS)[number]["value"]>("H1");
  const [window, setWindow] = useState<(typeof WINDOWS)[number]["value"]>("hann");
  const [averages, setAverages] = useState(20);
  const [overlap, setOverlap] = useState(50);
  const length = found.queries.filter((query) => query.field === "length_unit");
  const open = [...found.response_queries, ...(found.n_nodes > 0 ? length : [])];
  const show = (responses: number) => {
    onChange({ tab: "gvt", responses, upload: undefined });
  };
  const submit = () => {
    const request = { name: name.trim(), fuel: fuel / 100, ...units };
    if (isRecord) {
      estimate.mutate({ ...request, estimator, window, averages, overlap: overlap / 100 });
      return;
    }
    save.mutate(request, {
      onSuccess: (stored) => {
        show(stored.id);
      },
    });
  };
  const end = (job: Job) => {
    if (job.state !== "succeeded") return;
    void cache.invalidateQueries({ queryKey: ["measured-responses"] });
    const stored = job.result?.responses_id;
    if (typeof stored === "number") show(stored);
  };
  const failed = isRecord ? estimate : save;
  return (
    <Stack gap="xs" data-testid="responses-form">
      <Group align="end">
        <TextInput
          label="Name of the test"
          value={name}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <NumberField
          label="Fuel [%]"
          w={90}
          min={0}
          max={100}
          value={fuel}
          onChange={(value) => {
            if (value !== undefined) setFuel(value);
          }}
        />
        {open.map((query) => (
          <Select
            key={query.field}
            label={query.field === "length_unit" ? "Length unit" : query.text}
            w={140}
            data={[...query.choices]}
            value={units[query.field] ?? null}
            onChange={(value) => {
              setUnits((before) => ({ ...before, [query.field]: value ?? "" }));
            }}
          />
        ))}
        {isRecord && (
          <>
            <Select
              label="Estimator"
              w={230}
              allowDeselect={false}
              data={[...ESTIMATORS]}
              value={estimator}
              onChange={(value) => {
                setEstimator(ESTIMATORS.find((one) => one.value === value)?.value ?? "H1");
              }}
            />
            <Select
              label="Window"
              w={300}
              allowDeselect={false}
              data={[...WINDOWS]}
              value={window}
              onChange={(value) => {
                setWindow(WINDOWS.find((one) => one.value === value)?.value ?? "hann");
              }}
            />
            <NumberField
              label="Averages"
              allowDecimal={false}
              w={100}
              min={2}
              value={averages}
              onChange={(value) => {
                if (value !== undefined) setAverages(value);
              }}
            />
            <NumberField
              label="Overlap [%]"
              w={110}
              min={0}
              max={95}
              value={overlap}
              onChange={(value) => {
                if (value !== undefined) setOverlap(value);
              }}
            />
          </>
        )}
        <Button
          variant="default"
          loading={failed.isPending}
          disabled={name.trim() === "" || open.some((query) => !units[query.field])}
          onClick={submit}
        >
          {isRecord ? "Estimate responses" : "Save responses"}
        </Button>
      </Group>
      {failed.isError && <ProblemAlert error={failed.error} />}
      {estimate.data !== undefined && (
        <JobWait key={estimate.data.id} id={estimate.data.id} onEnd={end} />
      )}
    </Stack>
  );
}
