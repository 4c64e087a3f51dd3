import { Badge, Group, Text } from "@mantine/core";
import type { AdequacyState, ModelAdequacy, Run } from "../../api/types";
import { significant } from "../../lib/text/format";
import { tint } from "../../lib/figures/tint";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Section } from "../display/Section";

const COLORS: Record<AdequacyState, string> = {
  consistent: "green",
  suspect: "yellow",
  "not tested": "gray",
};

const REASONS: Record<AdequacyState, string> = {
  consistent: "No test for remaining model error rejects the model",
  suspect: "A test for remaining model error rejects the model: the run page lists the tests",
  "not tested": "No test for remaining model error applies: the run page gives the reason",
};

/** Result of the tests for remaining model error, as color and text. */
export function AdequacyBadge({ state, reason }: { state: AdequacyState; reason?: string }) {
  return (
    <Badge
      bg={tint(COLORS[state])}
      c="var(--mantine-color-text)"
      tt="none"
      miw="max-content"
      title={reason ?? REASONS[state]}
      data-testid="adequacy"
      data-state={state}
    >
      {state}
    </Badge>
  );
}

type Test = ModelAdequacy["tests"][number];

const COLUMNS: Column<Test>[] = [
  { key: "hypothesis", header: "Model error", render: (test) => test.hypothesis },
  { key: "subject", header: "Of", render: (test) => test.subject },
  numeric("statistic", "Statistic", (test) => significant(test.statistic, 3)),
  numeric("df", "Degrees of freedom", (test) => test.degrees_of_freedom || "–"),
  numeric("p", "p", (test) => significant(test.p, 2)),
  numeric("adjusted-p", <span title="Holm's method">p of all tests</span>, (test) =>
    significant(test.adjusted_p, 2),
  ),
  { key: "meaning", header: "Meaning", wraps: true, render: (test) => test.meaning },
];

interface TestsProps {
  adequacy: ModelAdequacy;
  /** What the tests are about. */
  title: string;
}

/** Badge and reason; the tests are on the tab of the checks. */
export function AdequacyLine({ adequacy, title }: TestsProps) {
  return (
    <Group
      gap="xs"
      mt="sm"
      wrap="nowrap"
      align="flex-start"
      data-testid={title.toLowerCase().replaceAll(" ", "-")}
    >
      <Text size="sm" style={{ whiteSpace: "nowrap" }}>
        {title}
      </Text>
      <AdequacyBadge state={adequacy.state} />
      <Text size="sm">{adequacy.reason}</Text>
    </Group>
  );
}

interface TableProps extends TestsProps {
  /** What a small p means. */
  note: string;
}

function Tests({ adequacy, title, note }: TableProps) {
  const rejecting = adequacy.tests.filter((test) => test.rejects).length;
  return (
    <Section
      title={title}
      note={`${String(adequacy.tests.length)} tests, ${String(rejecting)} ${rejecting === 1 ? "rejects" : "reject"}. ${note}`}
    >
      <DataTable
        label={title}
        columns={COLUMNS}
        rows={adequacy.tests}
        rowKey={(test) => `${test.hypothesis} ${test.subject}`}
        isSelected={(test) => test.rejects}
        maxHeight={480}
      />
    </Section>
  );
}

/** Tables of the tests for remaining model error and for an asymmetry of the aircraft. */
export function AdequacyTests({ run }: { run: Pick<Run, "adequacy" | "symmetry"> }) {
  const { adequacy, symmetry } = run;
  if (adequacy === null && symmetry === null) {
    return (
      <Empty title="No tests for remaining model error">
        Runs that failed, and runs of earlier releases, have none.
      </Empty>
    );
  }
  return (
    <div className="stack">
      {adequacy !== null && (
        <Tests
          adequacy={adequacy}
          title="Tests for remaining model error"
          note="The statistic is χ² with these degrees of freedom if the model is correct; that of a residual response or the consistency of a sensor is in standard deviations, and p of a residual power includes the errors of the noise measured in the band. A correct model is rejected by any of the tests with a probability of 5 %."
        />
      )}
      {symmetry !== null && (
        <Tests
          adequacy={symmetry}
          title="Tests for an asymmetry of aircraft or flight"
          note="Each test seeks a response of this axis to motion or surfaces of the other one. The statistic is χ² with these degrees of freedom for a symmetric aircraft; that of a cross response is in standard deviations. Any of the tests rejects a symmetric aircraft with a probability of 5 %."
        />
      )}
    </div>
  );
}
