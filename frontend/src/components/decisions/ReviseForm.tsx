import { Alert, Button, Group, Text } from "@mantine/core";
import { useReviseDecision } from "../../api/commands";
import { ApiProblem } from "../../api/problem";
import type { Decision, ModelStructure, StaleProposal } from "../../api/types";
import {
  draftOf,
  mergedProposal,
  type StoredProposal,
  type ProposalDraft,
} from "../../lib/drafts/proposal";
import { useDraft } from "../../lib/drafts/useDraft";
import { ConflictResolutions } from "../new-run/ConflictResolutions";
import { ProblemAlert } from "../display/ProblemAlert";
import { ProposalDifference } from "./ProposalDifference";
import { ProposalForm } from "./ProposalForm";

interface Revision {
  draft: ProposalDraft;
  /** Revision that was edited. */
  revision: number;
}

interface Props {
  decision: Decision;
  structures: ModelStructure[];
  /** With the revision that was made, where one was. */
  onDone: (revision?: number) => void;
}

/** Form to revise a proposal; a conflicting revision is shown. */
export function ReviseForm({ decision, structures, onDone }: Props) {
  const revise = useReviseDecision(decision.id);
  const {
    draft: revision,
    setDraft,
    discard,
  } = useDraft<Revision>(`flexsid.revision.${decision.id}`, {
    draft: draftOf(decision.proposal),
    revision: decision.revision,
  });
  const stale = staleOf(revise.error);
  const resolve = (proposal: StoredProposal, revision: number) => {
    setDraft({ draft: draftOf(proposal), revision });
    revise.reset();
  };
  return (
    <div className="stack">
      {stale !== null && <Conflict stale={stale} onResolve={resolve} />}
      <ProposalForm
        structures={structures}
        draft={revision.draft}
        onChange={(draft) => {
          setDraft({ ...revision, draft });
        }}
        sending={revise.isPending}
        label={`Revise revision ${revision.revision}`}
        footer={
          <Group>
            <Button
              variant="default"
              onClick={() => {
                discard();
                onDone();
              }}
            >
              Discard the revision
            </Button>
            {revise.isError && stale === null && <ProblemAlert error={revise.error} />}
          </Group>
        }
        onSend={(proposal) => {
          revise.mutate(
            { revision: revision.revision, proposal },
            {
              onSuccess: (made) => {
                discard();
                onDone(made.revision);
              },
            },
          );
        }}
      />
    </div>
  );
}

interface ConflictProps {
  stale: StaleProposal;
  onResolve: (proposal: StoredProposal, revision: number) => void;
}

function Conflict({ stale, onResolve }: ConflictProps) {
  const { base, current, sent, revision } = stale;
  const mine = sent ?? base;
  const both = mergedProposal(base, current, mine);
  return (
    <Alert color="yellow" variant="light" title="Revised by another analyst" data-testid="conflict">
      <Text size="sm" mb="sm">
        {stale.detail}. Your changes are preserved. Select a resolution, check the result, and send
        it again.
      </Text>
      <div className="halves">
        <ProposalDifference
          before={base}
          after={current}
          names={["You read", `Revision ${revision}`]}
        />
        <ProposalDifference before={base} after={mine} names={["You read", "Yours"]} />
      </div>
      <ConflictResolutions
        merged={both.proposal}
        mine={mine}
        theirs={current}
        clashes={both.clashes}
        onResolve={(proposal) => {
          onResolve(proposal, revision);
        }}
      />
    </Alert>
  );
}

function staleOf(error: unknown): StaleProposal | null {
  return error instanceof ApiProblem && error.code === "stale-edit"
    ? (error.body as StaleProposal)
    : null;
}
