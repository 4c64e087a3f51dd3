import { Alert, Button, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useEffect, useState } from "react";
import { useAnalyst } from "../api/analyst";
import { useMarkSeen } from "../api/commands";
import { decisionQuery, structuresQuery, voteEvidenceQuery } from "../api/queries";
import { isOpen, type Decision } from "../api/types";
import { AuditTrailMenu } from "../components/account/AuditTrailMenu";
import { DecisionBadge } from "../components/decisions/DecisionBadge";
import { DecisionComposer } from "../components/decisions/DecisionComposer";
import { DecisionThread } from "../components/decisions/DecisionThread";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProposalDifference } from "../components/decisions/ProposalDifference";
import { ProposalView } from "../components/decisions/ProposalView";
import { ReportMenu } from "../components/controls/ReportMenu";
import { ReviseForm } from "../components/decisions/ReviseForm";
import { Section } from "../components/display/Section";
import { EvidenceSummary } from "../components/decisions/VoteEvidence";
import type { DecisionView } from "../views";

const route = getRouteApi("/decisions/$id");

/** One decision: proposal, discussion and result. */
export function DecisionPage() {
  const { id } = route.useParams();
  const decision = useQuery(decisionQuery(id));
  return (
    <Loaded query={decision} page={`Decision ${id}`}>
      {(data) => <OneDecision key={id} decision={data} />}
    </Loaded>
  );
}

function OneDecision({ decision }: { decision: Decision }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const structures = useQuery(structuresQuery(decision.aircraft_id));
  const evidence = useQuery(voteEvidenceQuery(decision.id, decision.revision));
  const change = (part: Partial<DecisionView>) =>
    void navigate({ search: (before) => ({ ...before, ...part }), replace: true });
  // A vote applies to the revision that was read.
  const [read, setRead] = useState(decision.revision);
  useSeen(decision);
  const open = isOpen(decision.state);
  const revising = view.revise === true && open;
  return (
    <>
      <PageHead
        title={decision.proposal.title}
        trail={[
          <Link to="/decisions" className="link" key="decisions">
            Decisions
          </Link>,
        ]}
        aside={<DecisionBadge state={decision.state} />}
        actions={
          <>
            <ReportMenu of={`decision/${decision.id}`} />
            <AuditTrailMenu path={`decisions/${decision.id}/audit`} />
            {open && !revising && (
              <Button
                variant="default"
                data-testid="revise"
                onClick={() => {
                  change({ revise: true });
                }}
              >
                Revise
              </Button>
            )}
          </>
        }
      />
      <div className="decision">
        <div className="stack">
          <Notes decision={decision} read={read} onRead={setRead} />
          {revising ? (
            <Loaded query={structures}>
              {(all) => (
                <ReviseForm
                  decision={decision}
                  structures={all}
                  onDone={(revision) => {
                    if (revision !== undefined) setRead(revision);
                    change({ revise: undefined });
                  }}
                />
              )}
            </Loaded>
          ) : (
            <ProposalView
              decision={decision}
              derivative={view.derivative}
              onDerivative={(derivative) => {
                change({ derivative });
              }}
            />
          )}
        </div>
        <aside>
          <Section
            title="Discussion"
            note="Comments are never changed or deleted."
            actions={
              view.derivative !== undefined && (
                <Button
                  variant="subtle"
                  size="compact-xs"
                  style={{ flex: "none" }}
                  onClick={() => {
                    change({ derivative: undefined });
                  }}
                >
                  Whole proposal
                </Button>
              )
            }
          >
            <DecisionThread events={decision.events} derivative={view.derivative} />
            {open && (
              <Loaded query={evidence}>{(data) => <EvidenceSummary evidence={data} />}</Loaded>
            )}
            <DecisionComposer
              decision={decision}
              revision={read}
              derivative={view.derivative}
              consequence={evidence.data?.consequence}
              warnings={evidence.data?.warnings ?? []}
            />
          </Section>
        </aside>
      </div>
    </>
  );
}

/** Marks the decision as read, on opening and after each addition. */
function useSeen({ id, version }: Decision) {
  const name = useAnalyst();
  const { mutate } = useMarkSeen();
  useEffect(() => {
    if (name !== "") mutate({ subject: "decision", id });
  }, [name, id, version, mutate]);
}

interface NotesProps {
  decision: Decision;
  read: number;
  onRead: (revision: number) => void;
}

/** Changes around the proposal since it was made or read. */
function Notes({ decision, read, onRead }: NotesProps) {
  const { proposal, structure, newest_version, superseded_by, events, sheets } = decision;
  const before = events.findLast((one) => one.proposal !== null && one.revision <= read)?.proposal;
  return (
    <>
      {read < decision.revision && before && (
        <Alert
          color="yellow"
          variant="light"
          title="Revised since you read it"
          data-testid="revised"
        >
          <ProposalDifference
            before={before}
            after={proposal}
            names={[`Revision ${read}`, `Revision ${decision.revision}`]}
          />
          <Button
            mt="sm"
            data-testid="read-revision"
            onClick={() => {
              onRead(decision.revision);
            }}
          >
            I have read revision {decision.revision}
          </Button>
        </Alert>
      )}
      {superseded_by !== null && (
        <Alert color="gray" variant="light" title="Superseded">
          A{" "}
          <Link to="/decisions/$id" params={{ id: superseded_by }} className="link">
            later decision
          </Link>{" "}
          covers the whole range. This decision remains readable.
        </Alert>
      )}
      {sheets.map((sheet) => (
        <Text size="sm" key={sheet.id} data-testid="frozen-sheet">
          Sheet as it was when this was decided:{" "}
          <Link
            to="/conditions/$id"
            params={{ id: Number(sheet.query.split("=")[1]) }}
            search={{ frozen: sheet.id }}
            className="link"
          >
            {sheet.title}
          </Link>{" "}
          <span className="quiet">SHA-256 {sheet.array.slice(0, 12)}</span>
        </Text>
      ))}
      {structure !== null && newest_version > structure.version && isOpen(decision.state) && (
        <Text size="sm" data-testid="newer-structure">
          The structure has version {newest_version} by now.{" "}
          <Link
            to="/model-structures/$id"
            params={{ id: structure.structure_id }}
            search={{ against: structure.structure_id, against_version: structure.version }}
            className="link"
          >
            Differences
          </Link>
          ; a revision can propose it.
        </Text>
      )}
    </>
  );
}
