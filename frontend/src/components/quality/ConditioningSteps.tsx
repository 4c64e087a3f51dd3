import { Button, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useUndoCorrection } from "../../api/commands";
import { conditioningQuery } from "../../api/queries";
import type { ConditioningStep } from "../../api/types";
import { dateTime, fixed, significant } from "../../lib/text/format";
import { DataTable, type Column } from "../controls/DataTable";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";

/** Corrections, the newest first; undone ones remain listed. */
export function ConditioningSteps({ id }: { id: number }) {
  const steps = useQuery(conditioningQuery(id));
  const undo = useUndoCorrection(id);
  const columns: Column<ConditioningStep>[] = [
    { key: "channel", header: "Channel", render: (step) => step.channel },
    { key: "what", header: "Correction", render: (step) => words(step) },
    { key: "basis", header: "Basis", render: (step) => step.correction.basis || "–" },
    {
      key: "when",
      header: "Made",
      render: (step) => [dateTime(step.created_at), step.author].filter(Boolean).join(", "),
    },
    {
      key: "undo",
      header: "",
      render: (step) =>
        step.undone_at === null ? (
          <Button
            variant="subtle"
            size="compact-xs"
            loading={undo.isPending && undo.variables === step.id}
            aria-label={`Undo the ${step.correction.kind} of ${step.channel}`}
            onClick={() => {
              undo.mutate(step.id);
            }}
          >
            Undo
          </Button>
        ) : (
          <span className="quiet">undone {dateTime(step.undone_at)}</span>
        ),
    },
  ];
  return (
    <Loaded query={steps} rows={2}>
      {(items) =>
        items.length === 0 ? (
          <Text size="sm" className="quiet">
            No corrections.
          </Text>
        ) : (
          <>
            {undo.isError && <ProblemAlert error={undo.error} />}
            <DataTable
              label="Corrections"
              testId="conditioning-steps"
              columns={columns}
              rows={[...items].reverse()}
              rowKey={(step) => step.id}
              maxHeight={260}
            />
          </>
        )
      }
    </Loaded>
  );
}

function words({ correction }: ConditioningStep): string {
  if (correction.kind === "delay") {
    const std = correction.std === null ? "" : ` ± ${fixed(1e3 * correction.std, 2)}`;
    return `delay of ${fixed(1e3 * correction.delay_s, 2)}${std} ms corrected`;
  }
  if (correction.kind === "interpolation") return `${correction.between_samples} between samples`;
  if (correction.kind === "repair") {
    const samples = correction.stretches.reduce(
      (sum, [first = 0, stop = 0]) => sum + stop - first,
      0,
    );
    return `${samples} ${samples === 1 ? "sample" : "samples"} replaced by a spline`;
  }
  return `scale ${significant(correction.scale, 4)}, bias ${significant(correction.bias, 3)}`;
}
