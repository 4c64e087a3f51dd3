import { Button, Group, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useOrthogonality } from "../../api/commands";
import { jobQuery, modalTablesQuery, orthogonalityQuery } from "../../api/queries";
import type { Aircraft, Orthogonality, StructureFound } from "../../api/types";
import { fixed } from "../../lib/text/format";
import type { ModalDataView } from "../../views";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import { hasShapes, tableTitle } from "./tables";

const LENGTHS = ["m", "mm", "in", "ft"] as const;

interface Props {
  id: string;
  found: StructureFound;
  aircraft: Aircraft;
  fuel: number;
  onChange: (change: Partial<ModalDataView>) => void;
}

/** Orthogonality of modes over a mass matrix of the uploaded files. */
export function OrthogonalityForm({ id, found, aircraft, fuel, onChange }: Props) {
  const compute = useOrthogonality(id);
  const tables = (useQuery(modalTablesQuery(aircraft.id)).data ?? []).filter(hasShapes);
  const matrices = [...new Set(found.files.flatMap((file) => file.matrices))];
  const [mass, setMass] = useState<string | null>(null);
  const [stiffness, setStiffness] = useState<string | null>(null);
  const [table, setTable] = useState<string | null>(null);
  const [other, setOther] = useState<string | null>(null);
  const [length, setLength] = useState<(typeof LENGTHS)[number] | null>(null);
  const choices = tables.map((one) => ({ value: String(one.id), label: tableTitle(one) }));
  return (
    <Stack gap="xs">
      <Group align="end">
        <Select label="Mass matrix" data={matrices} value={mass} onChange={setMass} />
        <Select
          label="Modes"
          description="Table at the nodes of the matrix"
          data={choices}
          value={table}
          onChange={setTable}
        />
        <Select
          label="Compared with"
          description="Such as a test; else with itself"
          clearable
          data={choices}
          value={other}
          onChange={setOther}
        />
        <Select
          label="Stiffness matrix"
          description="Reduces the mass (Guyan)"
          clearable
          data={matrices}
          value={stiffness}
          onChange={setStiffness}
        />
        <Select
          label="Length unit of the matrices"
          description="Needed for rotations"
          clearable
          data={[...LENGTHS]}
          value={length}
          onChange={(value) => {
            setLength(LENGTHS.find((one) => one === value) ?? null);
          }}
        />
        <Button
          variant="default"
          disabled={mass === null || table === null}
          loading={compute.isPending}
          onClick={() => {
            if (mass !== null && table !== null)
              compute.mutate(
                {
                  mass,
                  modal_table_id: Number(table),
                  other_id: other === null ? null : Number(other),
                  stiffness,
                  length_unit: length,
                  fuel,
                  axes: "aft right up",
                },
                {
                  onSuccess: (job) => {
                    onChange({ orthogonality: job.id });
                  },
                },
              );
          }}
        >
          Compute orthogonality
        </Button>
      </Group>
      {compute.isError && <ProblemAlert error={compute.error} />}
    </Stack>
  );
}

/** The orthogonality that a job computes or has computed. */
export function OrthogonalityResult({ jobId }: { jobId: number }) {
  const job = useQuery(jobQuery(jobId)).data;
  return (
    <Section title="Orthogonality" note={job?.title}>
      <JobWait id={jobId} />
      {job?.state === "succeeded" && <StoredResult jobId={jobId} />}
    </Section>
  );
}

function StoredResult({ jobId }: { jobId: number }) {
  return (
    <Loaded query={useQuery(orthogonalityQuery(jobId))} rows={6}>
      {(result) => <Result result={result} />}
    </Loaded>
  );
}

function Result({ result }: { result: Orthogonality }) {
  const columns: Column<{ name: string; values: number[] }>[] = [
    { key: "name", header: "Mode", render: (row) => row.name },
    ...result.other_names.map((name, place) =>
      numeric<{ name: string; values: number[] }>(`${name} ${String(place)}`, name, (row) =>
        fixed(row.values[place] ?? null, 3),
      ),
    ),
  ];
  return (
    <Stack gap="xs">
      <Text size="sm" role="status">
        {`Pairs at least ${fixed(result.least_pair, 3)}, others at most ${fixed(result.worst, 3)}. ${result.notes.join(" ")}`}
      </Text>
      <DataTable
        label="Orthogonality"
        testId="orthogonality"
        columns={columns}
        rows={result.names.map((name, row) => ({ name, values: result.values[row] ?? [] }))}
        rowKey={(row) => row.name}
        maxHeight={420}
      />
    </Stack>
  );
}
