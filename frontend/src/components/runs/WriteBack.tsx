import { Alert, Button, Group, Stack, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { useUndoWriteBack, useWriteBack } from "../../api/commands";
import { maneuverQuery, writeBackProposalQuery, writeBacksQuery } from "../../api/queries";
import { asProblem } from "../../api/problem";
import type { Run, WriteBackItem, WriteBackProposal } from "../../api/types";
import { dateTime, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";

type Written = WriteBackProposal["parameters"][number];

const COLUMNS: Column<Written>[] = [
  { key: "name", header: "Parameter", render: (one) => <DerivativeName name={one.name} /> },
  numeric("before", "Before", (one) =>
    one.before === null ? "–" : withError(one.before, one.before_std).value,
  ),
  numeric("before-std", "σ", (one) =>
    one.before === null ? "–" : withError(one.before, one.before_std).error,
  ),
  numeric("after", "Written", (one) => withError(one.after, one.after_std).value),
  numeric("after-std", "σ", (one) => withError(one.after, one.after_std).error),
];

/** Writes the posterior of a run back into modal table and prediction, and undoes it. */
export function WriteBack({ run }: { run: Run }) {
  const proposal = useQuery(writeBackProposalQuery(run.id));
  const maneuver = useQuery(maneuverQuery(run.maneuver_id));
  return (
    <Section
      title="Write back"
      note="The posterior as the next version of modal table and prediction, from which runs of other maneuvers start"
    >
      {proposal.isError ? (
        <Empty title="Nothing to write back">{asProblem(proposal.error).detail}</Empty>
      ) : (
        <Loaded query={proposal}>{(found) => <Proposal run={run} found={found} />}</Loaded>
      )}
      {maneuver.data !== undefined && <WriteBacks aircraftId={maneuver.data.aircraft_id} />}
    </Section>
  );
}

function Proposal({ run, found }: { run: Run; found: WriteBackProposal }) {
  const [reason, setReason] = useState("");
  const write = useWriteBack(run.id);
  return (
    <Stack gap="sm">
      <Text size="sm">{found.sentence}</Text>
      {found.warnings.map((text) => (
        <Alert key={text} color="yellow" variant="light">
          {text}
        </Alert>
      ))}
      <DataTable
        label="Parameters that are written back"
        columns={COLUMNS}
        rows={found.parameters}
        rowKey={(one) => one.name}
        maxHeight={320}
      />
      <form
        onSubmit={(event) => {
          event.preventDefault();
          write.mutate(reason);
        }}
      >
        <Group gap="sm" align="end">
          <TextInput
            label="Reason"
            required
            maxLength={2000}
            style={{ flexGrow: 1 }}
            value={reason}
            onChange={(event) => {
              setReason(event.currentTarget.value);
            }}
          />
          <Button type="submit" loading={write.isPending} data-testid="write-back">
            Write back
          </Button>
        </Group>
      </form>
      {write.isError && <ProblemAlert error={write.error} />}
    </Stack>
  );
}

/** All write-backs of an aircraft, the newest first; undone ones remain listed. */
function WriteBacks({ aircraftId }: { aircraftId: number }) {
  const found = useQuery(writeBacksQuery(aircraftId));
  const undo = useUndoWriteBack();
  const columns: Column<WriteBackItem>[] = [
    {
      key: "run",
      header: "Run",
      render: (one) => (
        <Link to="/runs/$id" params={{ id: one.run_id }} className="link">
          {one.run_id}
        </Link>
      ),
    },
    { key: "what", header: "Written", wraps: true, render: (one) => one.sentence },
    { key: "reason", header: "Reason", wraps: true, render: (one) => one.reason },
    {
      key: "when",
      header: "Made",
      render: (one) => [dateTime(one.created_at), one.author].filter(Boolean).join(", "),
    },
    {
      key: "undo",
      header: "",
      render: (one) =>
        one.undone_at === null ? (
          <Button
            variant="subtle"
            size="compact-xs"
            loading={undo.isPending && undo.variables === one.id}
            aria-label={`Undo the write-back of run ${one.run_id}`}
            title="The former versions are the default again; nothing is deleted"
            onClick={() => {
              undo.mutate(one.id);
            }}
          >
            Undo
          </Button>
        ) : (
          <span className="quiet">
            undone {[dateTime(one.undone_at), one.undone_by].filter(Boolean).join(", ")}
          </span>
        ),
    },
  ];
  return (
    <Loaded query={found} rows={2}>
      {(items) =>
        items.length === 0 ? null : (
          <div style={{ marginTop: 16 }}>
            {undo.isError && <ProblemAlert error={undo.error} />}
            <DataTable
              label="Write-backs"
              testId="write-backs"
              columns={columns}
              rows={items}
              rowKey={(one) => one.id}
            />
          </div>
        )
      }
    </Loaded>
  );
}
