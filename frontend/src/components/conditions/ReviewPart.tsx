import { Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { Fragment } from "react";
import { decisionQuery, voteEvidenceQuery } from "../../api/queries";
import type { ConditionSheet, Decision, VoteEvidence } from "../../api/types";
import { isOpen } from "../../api/types";
import { parseDerivative } from "../../lib/derivatives";
import { fixed, hertz, signedWith, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DecisionBadge } from "../decisions/DecisionBadge";
import { DecisionComposer } from "../decisions/DecisionComposer";
import { DerivativeName } from "../display/DerivativeName";
import { Loaded } from "../display/Loaded";
import { StructureLink } from "../structures/StructureLink";

/** State of a derivative of a mode or surface that the model does not have. */
const ABSENT = "not in the model";

type Reference = NonNullable<VoteEvidence["reference"]>;
type Change = Reference["largest_changes"][number];
type Pole = Reference["poles"][number];
type HeldOut = Reference["held_out"][number];

/** Signed difference of a derivative from the baseline, in σ. */
const sigmaOf = (one: Change) =>
  signedWith(Math.sign(one.value - one.baseline_value) * one.difference_sigma, 2, "σ");

const CHANGES: Column<Change>[] = [
  { key: "name", header: "Derivative", render: (one) => <DerivativeName name={one.name} /> },
  numeric(
    "before",
    "Baseline",
    (one) => withError(one.baseline_value, 2 * (one.baseline_std_error ?? 0)).value,
  ),
  numeric("after", "Proposal", (one) => withError(one.value, 2 * (one.std_error ?? 0)).value),
  numeric("sigma", "Change", sigmaOf),
];

const POLES: Column<Pole>[] = [
  { key: "name", header: "Mode", render: (one) => one.name },
  numeric(
    "frequency",
    "Frequency",
    (one) =>
      `${one.baseline_frequency === null ? "–" : fixed(hertz(one.baseline_frequency), 3)} → ${one.frequency === null ? "–" : fixed(hertz(one.frequency), 3)}`,
    "Hz",
  ),
  numeric(
    "damping",
    "Damping",
    (one) =>
      `${one.baseline_damping === null ? "–" : fixed(100 * one.baseline_damping, 2)} → ${one.damping === null ? "–" : fixed(100 * one.damping, 2)}`,
    "%",
  ),
];

const HELD_OUT: Column<HeldOut>[] = [
  { key: "output", header: "Output", render: (one) => one.output },
  { key: "record", header: "Of", render: (one) => one.maneuver_label },
  numeric("r2", "R²", (one) => `${fixed(one.baseline_r_squared, 4)} → ${fixed(one.r_squared, 4)}`),
];

/** What a decision on the structure of the sheet would change, in two lines at its head. */
export function ReviewSummary({ sheet }: { sheet: ConditionSheet }) {
  const decision = useDecision(sheet);
  const evidence = useEvidence(decision.data);
  if (sheet.structure === null) return null;
  const { structure } = sheet;
  const reference = evidence.data?.reference ?? null;
  return (
    <div className="sheet-review" data-testid="sheet-change">
      <span className="quiet">Model structure</span>
      <strong>
        <StructureLink
          name={structure.name}
          id={structure.structure_id}
          version={structure.version}
        />{" "}
        {decision.data !== undefined && <DecisionBadge state={decision.data.state} />}
      </strong>
      {reference !== null && (
        <span>
          <strong>
            Against {reference.name}
            {reference.decision_id !== null && ` (decision ${reference.decision_id})`}:
          </strong>{" "}
          {termsOf(reference)}
          {reference.n_derivatives > 0 &&
            `, ${reference.derivatives.length} of ${reference.n_derivatives} shared moved by more than 2σ`}
          {reference.flutter_change_m_s !== null &&
            `, flutter speed ${signedWith(reference.flutter_change_m_s, 1, " m/s")}`}
          .
          {reference.largest_changes.length > 0 && (
            <>
              {" "}
              Most changed:{" "}
              {reference.largest_changes.map((one, index) => (
                <Fragment key={one.name}>
                  {index > 0 && ", "}
                  <span className="nowrap">
                    <DerivativeName name={one.name} /> {sigmaOf(one)}
                  </span>
                </Fragment>
              ))}
              .
            </>
          )}
        </span>
      )}
      {decision.data !== undefined && isOpen(decision.data.state) && (
        <a href="#review" className="link no-print">
          Decide
        </a>
      )}
    </div>
  );
}

/** Terms that a proposal adds and removes, counted. */
function termsOf(reference: Reference): string {
  const terms = reference.terms.filter((one) => parseDerivative(one.what) !== null);
  const added = terms.filter((one) => one.before === ABSENT).length;
  const removed = terms.filter((one) => one.after === ABSENT).length;
  const parts = [
    [added, "added"],
    [removed, "removed"],
    [terms.length - added - removed, "changed"],
  ].flatMap(([n, word]) => (n === 0 ? [] : [`${n} ${word}`]));
  return parts.length === 0 ? "no derivative added or removed" : `derivatives ${parts.join(", ")}`;
}

/** The decision beside its evidence: what changed, what is open, and what approval does. */
export function ReviewPart({ sheet }: { sheet: ConditionSheet }) {
  const decision = useDecision(sheet);
  const evidence = useEvidence(decision.data);
  if (sheet.decision_id === null) {
    return (
      <section className="sheet-part sheet-wide" id="review" aria-label="Review">
        <h2>Review</h2>
        <Text size="sm">
          {sheet.baseline_name === null
            ? "No model structure is approved or proposed at this condition."
            : `Baseline: ${sheet.baseline_name}, decision ${sheet.baseline_decision_id}.`}{" "}
          {sheet.structure !== null && (
            <Link
              to="/decisions/new"
              search={{ structure: sheet.structure.structure_id }}
              className="link no-print"
            >
              Propose {sheet.structure.name}
            </Link>
          )}
        </Text>
      </section>
    );
  }
  return (
    <section className="sheet-part sheet-wide" id="review" aria-label="Review">
      <Loaded query={decision}>
        {(data) => (
          <>
            <h2>
              Review{" "}
              <span className="quiet">
                <Link to="/decisions/$id" params={{ id: data.id }} className="link">
                  decision {data.id}
                </Link>
                , proposed by {data.authors.join(", ")}: “{data.proposal.reasoning}”
              </span>
            </h2>
            <Loaded query={evidence}>
              {(found) => <Evidence decision={data} evidence={found} />}
            </Loaded>
          </>
        )}
      </Loaded>
    </section>
  );
}

function Evidence({ decision, evidence }: { decision: Decision; evidence: VoteEvidence }) {
  const { reference } = evidence;
  return (
    <div className="sheet-decision">
      {reference !== null && (
        <div>
          <h3>Most changed of {reference.n_derivatives} shared derivatives, same record</h3>
          <DataTable
            label="Most changed derivatives"
            columns={CHANGES}
            rows={reference.largest_changes}
            rowKey={(one) => `${one.run_id} ${one.name}`}
          />
        </div>
      )}
      {reference !== null && (
        <div>
          <h3>Poles and held-out prediction, baseline → proposal</h3>
          <DataTable
            label="Change of poles"
            columns={POLES}
            rows={reference.poles}
            rowKey={(one) => one.name}
          />
          {reference.held_out.length > 0 && (
            <DataTable
              label="Change of the held-out prediction"
              columns={HELD_OUT}
              rows={reference.held_out.slice(0, 3)}
              rowKey={(one) => `${one.maneuver_label} ${one.output}`}
            />
          )}
        </div>
      )}
      <div>
        <h3>
          {evidence.warnings.length === 0
            ? "No open warning"
            : `Open warnings: ${evidence.warnings.length}`}
        </h3>
        <ul className="links">
          {evidence.warnings.map((text) => (
            <li key={text}>
              <Text size="xs">{text}</Text>
            </li>
          ))}
        </ul>
        <Text size="sm" fw={600} className="print-only">
          Approval {evidence.consequence}.
        </Text>
        <div className="no-print">
          {isOpen(decision.state) && (
            <DecisionComposer
              decision={decision}
              revision={decision.revision}
              consequence={evidence.consequence}
              warnings={evidence.warnings}
            />
          )}
        </div>
        <div className="print-only sheet-signatures">
          <span>Approved, name and date</span>
          <span>Changes requested, name and date</span>
        </div>
      </div>
    </div>
  );
}

function useDecision(sheet: ConditionSheet) {
  const id = sheet.decision_id;
  return useQuery({ ...decisionQuery(id ?? 0), enabled: id !== null });
}

function useEvidence(decision: Decision | undefined) {
  return useQuery({
    ...voteEvidenceQuery(decision?.id ?? 0, decision?.revision ?? 0),
    enabled: decision !== undefined,
  });
}
