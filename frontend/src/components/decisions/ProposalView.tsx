import { Badge, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { aircraftQuery, voteEvidenceQuery } from "../../api/queries";
import type { ReactNode } from "react";
import type { Decision, Proposal } from "../../api/types";
import { useConversion } from "../../api/units";
import { derivativeNames } from "../../lib/derivatives";
import { limitsText } from "../../lib/limits";
import { differences } from "../../lib/structure";
import { Facts } from "../display/ConditionFacts";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { Section } from "../display/Section";
import { StructureDifference } from "../structures/StructureDifference";
import { StructureGrid } from "../new-run/StructureGrid";
import { StructureLink } from "../structures/StructureLink";
import { EvidenceTables } from "./VoteEvidence";

type GlobalModel = NonNullable<Decision["global_model"]>;

interface Props {
  decision: Decision;
  derivative?: string;
  onDerivative: (name: string | undefined) => void;
}

/** Proposal with its range of conditions, reasoning and evidence. */
export function ProposalView({ decision, ...props }: Props) {
  const { structure, global_model: model } = decision;
  return (
    <>
      {model !== null && <GlobalModelProposal decision={decision} model={model} />}
      {structure !== null && (
        <StructureProposal decision={decision} structure={structure} {...props} />
      )}
      <Evidence decision={decision} />
    </>
  );
}

/** Rows of facts of every proposal. */
function useReviewFacts({ proposal, decision }: { proposal: Proposal; decision: Decision }) {
  const convert = useConversion();
  const { rules } = decision;
  return [
    [
      "For",
      proposal.structure === null
        ? "the envelope of its runs"
        : limitsText(proposal.limits, convert),
    ],
    ["Axis", decision.axis],
    ["By", decision.authors.join(", ")],
    ["Revision", decision.revision],
    [
      "Rules",
      `quorum ${rules.quorum}, ${rules.own_allowed ? "own proposals allowed" : "own proposals excluded"}`,
    ],
    [
      "Votes",
      Object.entries(decision.votes)
        .map(([name, vote]) => `${name}: ${vote.replace("-", " ")}`)
        .join(", ") || "none yet",
    ],
  ] satisfies [string, ReactNode][];
}

function GlobalModelProposal({ decision, model }: { decision: Decision; model: GlobalModel }) {
  const { proposal } = decision;
  const facts = useReviewFacts({ proposal, decision });
  const outlying = model.runs.filter((run) => run.is_outlying).map((run) => run.run_id);
  return (
    <Section title="Proposal">
      <Facts
        facts={[
          [
            "Global model",
            <Link key="model" to="/global-model/$id" params={{ id: model.id }} className="link">
              version {model.version}: {model.label}
            </Link>,
          ],
          ["Runs", model.runs.length],
          ["Outlying runs, excluded", outlying.join(", ") || "none"],
          ...facts,
        ]}
      />
      <Text mt="sm" size="sm">
        {model.sentence}
      </Text>
      <Text mt="sm" style={{ whiteSpace: "pre-wrap", overflowWrap: "anywhere" }}>
        {proposal.reasoning}
      </Text>
    </Section>
  );
}

interface StructureProps extends Props {
  structure: NonNullable<Decision["structure"]>;
}

function StructureProposal({ decision, structure, derivative, onDerivative }: StructureProps) {
  const aircraft = useQuery(aircraftQuery);
  const craft = aircraft.data?.find((one) => one.id === decision.aircraft_id);
  const surfaces = craft?.surfaces.map((one) => one.name) ?? [];
  const { proposal, changes } = decision;
  const facts = useReviewFacts({ proposal, decision });
  const { modes, inputs: named, axis } = structure.structure;
  const inputs = named.length > 0 ? named : surfaces;
  const all = derivativeNames(modes, inputs, axis);
  const found =
    changes === null ? [] : differences(changes.structure, structure.structure, surfaces);
  const before = new Map(found.map((one) => [one.what, one.before]));
  const comments = new Map<string, number>();
  for (const { derivative: name } of decision.events) {
    if (name !== null) comments.set(name, (comments.get(name) ?? 0) + 1);
  }
  return (
    <>
      <Section title="Proposal">
        <Facts
          facts={[
            [
              "Structure",
              <StructureLink
                key="structure"
                name={structure.name}
                id={structure.structure_id}
                version={structure.version}
              />,
            ],
            [
              "Changes",
              changes === null ? (
                "none"
              ) : (
                <StructureLink
                  key="changes"
                  name={changes.name}
                  id={changes.structure_id}
                  version={changes.version}
                />
              ),
            ],
            ...facts,
          ]}
        />
        <Text mt="sm" style={{ whiteSpace: "pre-wrap", overflowWrap: "anywhere" }}>
          {proposal.reasoning}
        </Text>
      </Section>
      <Section
        title="Derivatives"
        note={
          changes === null
            ? "Select one to comment on it."
            : "Outlined ones change. Select one to comment on it."
        }
      >
        <StructureGrid
          axis={axis}
          modes={modes}
          inputs={inputs}
          states={structure.structure}
          onChange={() => undefined}
          current={derivative !== undefined && all.includes(derivative) ? derivative : undefined}
          onCurrent={onDerivative}
          before={(name) => before.get(name)}
          readOnly
          marks={(name) => {
            const count = comments.get(name);
            return (
              count !== undefined && (
                <Badge size="xs" circle aria-label={`${count} comments`}>
                  {count}
                </Badge>
              )
            );
          }}
        />
        {changes !== null && (
          <StructureDifference
            found={found}
            before={`${changes.name}, version ${changes.version}`}
            after={`${structure.name}, version ${structure.version}`}
          />
        )}
      </Section>
    </>
  );
}

function Evidence({ decision }: { decision: Decision }) {
  const { proposal, figures } = decision;
  const evidence = useQuery(voteEvidenceQuery(decision.id, decision.revision));
  return (
    <Section title="Evidence">
      <Loaded query={evidence}>{(data) => <EvidenceTables evidence={data} />}</Loaded>
      {proposal.comparisons.length > 0 && (
        <ul className="links">
          {proposal.comparisons.map((one, index) => (
            <li key={`comparison ${index}`}>
              <Link
                to="/compare"
                search={{
                  runs: one.run_ids,
                  predictions: one.prediction_ids,
                  coefficient: one.coefficient ?? undefined,
                }}
                className="link"
              >
                Comparison of runs {one.run_ids.join(", ")}
                {one.prediction_ids.length > 0 &&
                  ` and predictions ${one.prediction_ids.join(", ")}`}
              </Link>
            </li>
          ))}
        </ul>
      )}
      {figures.map((one) => (
        <div key={one.id}>
          <Figure kind="frozen" title={`${one.title} (frozen)`} params={{ figure_id: one.id }} />
        </div>
      ))}
    </Section>
  );
}
