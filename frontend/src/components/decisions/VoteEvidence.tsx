import { Text } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import type { VoteEvidence } from "../../api/types";
import { fixed, percent, significant, withError } from "../../lib/text/format";
import { Facts } from "../display/ConditionFacts";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { AdequacyBadge } from "../runs/ModelAdequacy";
import { Quantity, quantity, quantityFact } from "../display/Quantity";
import { StructureLink } from "../structures/StructureLink";

type Run = VoteEvidence["runs"][number];
type Reference = NonNullable<VoteEvidence["reference"]>;
type Moved = Reference["derivatives"][number];
type Term = Reference["terms"][number];
type Flutter = VoteEvidence["flutter"];
type Search = VoteEvidence["searches"][number];

function RunLink({ id, text }: { id: number; text?: string }) {
  return (
    <Link to="/runs/$id" params={{ id }} className="link">
      {text ?? id}
    </Link>
  );
}

const RUNS: Column<Run>[] = [
  {
    key: "run",
    header: "Run",
    render: (one) => <RunLink id={one.run_id} text={`${one.method} ${one.run_id}`} />,
  },
  {
    key: "maneuver",
    header: "Maneuver",
    yields: true,
    render: (one) => (
      <Link to="/maneuvers/$id" params={{ id: one.maneuver_id }} className="link">
        {one.maneuver_label}
      </Link>
    ),
  },
  quantity("airspeed", "Airspeed", (one) => one.airspeed_m_s, "m/s", 1),
  numeric("fuel", "Fuel", (one) => percent(one.fuel_fraction), "%"),
  { key: "outcome", header: "Outcome", render: (one) => one.outcome },
  numeric("r2", "Lowest R²", (one) => fixed(one.lowest_r_squared, 3)),
  { key: "output", header: "Of output", render: (one) => one.lowest_output ?? "–" },
  {
    key: "adequacy",
    header: "Model adequacy",
    render: (one) => <AdequacyBadge state={one.adequacy} />,
  },
  {
    key: "baseline",
    header: "Baseline run",
    render: (one) => (one.baseline_run_id === null ? "none" : <RunLink id={one.baseline_run_id} />),
  },
];

const SEARCHES: Column<Search>[] = [
  { key: "search", header: "Search", render: (one) => `${one.method} ${one.search_id}` },
  {
    key: "maneuvers",
    header: "Maneuvers",
    yields: true,
    render: (one) => one.maneuver_labels.join(", "),
  },
  numeric("terms", "Terms", (one) => `${one.n_terms} of ${one.n_candidate_terms}`),
  {
    key: "adequacy",
    header: "Model adequacy, all terms",
    render: (one) => <AdequacyBadge state={one.adequacy} />,
  },
  numeric("held-out", "Held-out log likelihood over all terms", (one) =>
    fixed(one.likelihood_difference, 1),
  ),
  { key: "proposed", header: "Proposed", render: (one) => (one.is_proposed ? "yes" : "no") },
];

const TERMS: Column<Term>[] = [
  { key: "what", header: "Term", render: (one) => <DerivativeName name={one.what} /> },
  { key: "before", header: "Baseline", wraps: true, render: (one) => one.before },
  { key: "after", header: "Proposed", wraps: true, render: (one) => one.after },
];

const written = (value: number, stdError: number | null) => {
  const { value: digits, error } = withError(value, stdError === null ? null : 2 * stdError);
  return `${digits} ± ${error}`;
};

const MOVED: Column<Moved>[] = [
  { key: "name", header: "Derivative", render: (one) => <DerivativeName name={one.name} /> },
  numeric("baseline", "Baseline ±2σ", (one) => written(one.baseline_value, one.baseline_std_error)),
  numeric("proposed", "Proposed ±2σ", (one) => written(one.value, one.std_error)),
  numeric("difference", "Difference", (one) => significant(one.difference_sigma, 2), "σ"),
  {
    key: "runs",
    header: "Runs",
    render: (one) => (
      <Link
        to="/compare"
        search={{ runs: [one.baseline_run_id, one.run_id], differences: true }}
        className="link"
      >
        {one.baseline_run_id}, {one.run_id}
      </Link>
    ),
  },
];

/** Flutter speed with its interval; a link to the prediction where none is stored. */
function FlutterSpeed({ flutter }: { flutter: Flutter }) {
  if (flutter.run_ids.length === 0) return <>no run to predict it from</>;
  const link = (text: ReactNode) => (
    <Link to="/flutter" search={{ runs: flutter.run_ids }} className="link">
      {text}
    </Link>
  );
  if (flutter.sentence === null) return <>not computed ({link("predict flutter")})</>;
  if (flutter.airspeed_m_s === null) return link("no flutter speed found");
  const interval =
    flutter.low_m_s === null ? (
      ", interval unknown"
    ) : (
      <>
        {" "}
        (<Quantity value={flutter.low_m_s} unit="m/s" decimals={1} /> to{" "}
        <Quantity value={flutter.high_m_s} unit="m/s" decimals={1} named />, 95 %)
      </>
    );
  return (
    <>
      {link(<Quantity value={flutter.airspeed_m_s} unit="m/s" decimals={1} named />)}
      {interval}
    </>
  );
}

/** What is missing or speaks against the proposal. */
function EvidenceWarnings({ evidence }: { evidence: VoteEvidence }) {
  if (evidence.warnings.length === 0) return null;
  return (
    <ul className="links" data-testid="evidence-warnings">
      {evidence.warnings.map((text) => (
        <li key={text}>
          <Text size="sm" c="var(--page-warn)">
            {text}
          </Text>
        </li>
      ))}
    </ul>
  );
}

/** What to read before a vote, in a few lines. */
export function EvidenceSummary({ evidence }: { evidence: VoteEvidence }) {
  const { runs, reference, flutter } = evidence;
  const fits = runs.map((one) => one.lowest_r_squared).filter((one) => one !== null);
  const consistent = runs.filter((one) => one.adequacy === "consistent").length;
  const change = reference?.flutter_change_m_s ?? null;
  return (
    <div
      className="stack"
      role="group"
      aria-label="Evidence for a vote"
      data-testid="vote-evidence"
    >
      <EvidenceWarnings evidence={evidence} />
      {runs.length > 0 && (
        <Facts
          facts={[
            ["Runs", runs.length],
            ["Lowest R²", fits.length === 0 ? "–" : fixed(Math.min(...fits), 3)],
            ["Model adequacy", `${consistent} of ${runs.length} consistent`],
            ...(reference === null
              ? []
              : ([
                  ["Terms changed", reference.terms.length],
                  [
                    "Moved by more than 2 σ",
                    `${reference.derivatives.length} of ${reference.n_derivatives}`,
                  ],
                ] as [string, string | number][])),
            ["Flutter speed", <FlutterSpeed key="flutter" flutter={flutter} />],
            ...(change === null ? [] : [quantityFact("Change of flutter speed", change, "m/s", 1)]),
          ]}
        />
      )}
    </div>
  );
}

/** Evidence in full: runs with their warnings, and comparison with the baseline. */
export function EvidenceTables({ evidence }: { evidence: VoteEvidence }) {
  const { runs, reference, flutter, searches } = evidence;
  const warned = runs.filter((one) => one.warnings.length > 0);
  return (
    <div className="stack" data-testid="evidence-tables">
      {runs.length > 0 && (
        <DataTable
          label="Runs of the proposal"
          columns={RUNS}
          rows={runs}
          rowKey={(one) => one.run_id}
        />
      )}
      {searches.length > 0 && (
        <DataTable
          label="Searches of the model structure"
          columns={SEARCHES}
          rows={searches}
          rowKey={(one) => one.search_id}
        />
      )}
      {warned.length > 0 && (
        <details>
          <summary>Warnings of {warned.length === 1 ? "one run" : `${warned.length} runs`}</summary>
          <ul className="links">
            {warned.flatMap((one) =>
              one.warnings.map((text) => (
                <li key={`${one.run_id} ${text}`}>
                  <Text size="sm">
                    Run {one.run_id}: {text}
                  </Text>
                </li>
              )),
            )}
          </ul>
        </details>
      )}
      {reference !== null && <ReferencePart reference={reference} flutter={flutter} />}
      {reference === null && runs.length > 0 && (
        <Text size="sm" className="quiet">
          No baseline is approved for this range, and the proposal changes no earlier structure:
          there is nothing to compare it with.
        </Text>
      )}
    </div>
  );
}

function ReferencePart({ reference, flutter }: { reference: Reference; flutter: Flutter }) {
  const { structure, terms, derivatives } = reference;
  const what = reference.decision_id === null ? "the structure that it changes" : "the baseline";
  return (
    <>
      <Text size="sm">
        Compared with {what},{" "}
        <StructureLink name={reference.name} id={structure.id} version={structure.version} />:
      </Text>
      {terms.length > 0 ? (
        <details>
          <summary>
            {terms.length === 1 ? "One term differs" : `${terms.length} terms differ`}
          </summary>
          <DataTable
            label="Terms that differ"
            columns={TERMS}
            rows={terms}
            rowKey={(one) => one.what}
          />
        </details>
      ) : (
        <Text size="sm">The model structures are equal.</Text>
      )}
      {derivatives.length > 0 && (
        <DataTable
          label="Derivatives that moved by more than 2 standard errors"
          columns={MOVED}
          rows={derivatives}
          rowKey={(one) => `${one.run_id} ${one.name}`}
          maxHeight={260}
        />
      )}
      {reference.n_derivatives > 0 && (
        <Text size="sm">
          {derivatives.length} of {reference.n_derivatives} derivatives moved by more than 2
          standard errors of the difference, in view of the noise that both runs share.
        </Text>
      )}
      <Facts
        facts={[
          ["Flutter speed, proposed", <FlutterSpeed key="proposed" flutter={flutter} />],
          ["Flutter speed, baseline", <FlutterSpeed key="baseline" flutter={reference.flutter} />],
          quantityFact("Change", reference.flutter_change_m_s, "m/s", 1),
        ]}
      />
    </>
  );
}
