import { Button, Group, Select, Stack, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { useRehearse } from "../api/commands";
import { controllersQuery, rehearsalsQuery } from "../api/queries";
import type { Design, RehearsalResult, RehearsedDerivative } from "../api/types";
import { fixed, withError } from "../lib/format";
import { DataTable, type Column } from "./DataTable";
import { DerivativeName } from "./DerivativeName";
import { Empty } from "./Empty";
import { Loaded } from "./Loaded";
import { ProblemAlert } from "./ProblemAlert";
import { Section } from "./Section";
import { TaskProgress } from "./TaskProgress";

const away = (row: RehearsedDerivative) =>
  row.std_error === null || row.std_error === 0 ? null : (row.estimate - row.flown) / row.std_error;

const COLUMNS: Column<RehearsedDerivative>[] = [
  { key: "name", header: "Derivative", render: (row) => <DerivativeName name={row.name} /> },
  {
    key: "flown",
    header: "Flew with",
    numeric: true,
    render: (row) => withError(row.flown, row.std_error).value,
  },
  {
    key: "estimate",
    header: "Estimated",
    numeric: true,
    render: (row) => withError(row.estimate, row.std_error).value,
  },
  {
    key: "error",
    header: "σ",
    numeric: true,
    render: (row) => withError(row.estimate, row.std_error).error,
  },
  {
    key: "expected",
    header: "Expected σ",
    numeric: true,
    render: (row) => withError(row.flown, row.expected).error,
  },
  { key: "away", header: "Off by", unit: "σ", numeric: true, render: (row) => fixed(away(row), 1) },
];

interface Props {
  design: Design;
  level: number;
  run: number;
}

/** The design flown in closed-loop simulation with a run's model, then estimated. */
export function RehearsalPart({ design, level, run }: Props) {
  const controllers = useQuery(controllersQuery);
  const rehearsals = useQuery(rehearsalsQuery(design.id));
  const rehearse = useRehearse(design.id);
  const cache = useQueryClient();
  const [controller, setController] = useState<string | null>(null);
  const known = controllers.data ?? [];
  const chosen = controller ?? String(known[0]?.id ?? "");
  return (
    <>
      <Section
        title="Rehearsal"
        note="Model, condition, sensors and noise of the run; surfaces through their actuators. What is recorded is kept as a maneuver of flight 0 and estimated as the run was"
      >
        <Stack gap="sm">
          <Group align="end">
            <Select
              label="Controller"
              w={360}
              allowDeselect={false}
              data={[
                ...known.map((one) => ({ value: String(one.id), label: one.name })),
                { value: "none", label: "None: open loop" },
              ]}
              value={chosen === "" ? "none" : chosen}
              onChange={setController}
            />
            <Button
              loading={rehearse.isPending}
              data-testid="rehearse"
              onClick={() => {
                const id = Number(chosen);
                rehearse.mutate({
                  run_id: run,
                  level,
                  controller_id: Number.isInteger(id) && id > 0 ? id : null,
                });
              }}
            >
              Fly it
            </Button>
          </Group>
          {rehearse.isError && <ProblemAlert error={rehearse.error} />}
          {rehearse.data !== undefined && (
            <TaskProgress
              key={rehearse.data.id}
              task={rehearse.data}
              onMade={() =>
                void cache.invalidateQueries({ queryKey: rehearsalsQuery(design.id).queryKey })
              }
            />
          )}
        </Stack>
      </Section>
      <Loaded query={rehearsals} rows={6}>
        {(found) =>
          found.length === 0 ? (
            <Empty title="Not rehearsed yet">
              A rehearsal shows responses, correlations and estimates before anyone flies.
            </Empty>
          ) : (
            <>
              {found.map((one) => (
                <One key={one.rehearsal.id} result={one} />
              ))}
            </>
          )
        }
      </Loaded>
    </>
  );
}

function One({ result }: { result: RehearsalResult }) {
  const { rehearsal, derivatives } = result;
  const off = derivatives.flatMap((row) => away(row) ?? []);
  const rms = Math.sqrt(off.reduce((sum, z) => sum + z * z, 0) / Math.max(1, off.length));
  return (
    <Section
      title={result.label}
      note={`Largest correlation between two surfaces ${fixed(result.correlation, 3)}`}
      actions={
        <Group gap="sm">
          <Link
            to="/maneuvers/$id"
            params={{ id: rehearsal.maneuver_id }}
            search={{ tab: "time" }}
            className="link"
          >
            Responses
          </Link>
          <Link
            to="/maneuvers/$id"
            params={{ id: rehearsal.maneuver_id }}
            search={{ tab: "inputs" }}
            className="link"
          >
            Correlation
          </Link>
          <Link to="/runs/$id" params={{ id: rehearsal.run_id }} className="link">
            Run {rehearsal.run_id}
          </Link>
        </Group>
      }
    >
      {derivatives.length === 0 ? (
        <Text size="sm">The estimation is {result.state}.</Text>
      ) : (
        <>
          <p className="quiet">
            Estimates are off what flew by {fixed(rms, 2)} standard errors, root mean square.
          </p>
          <DataTable
            label="What flew and what was estimated"
            testId="rehearsed-derivatives"
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
