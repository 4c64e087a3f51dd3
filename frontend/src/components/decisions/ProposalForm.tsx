import {
  Button,
  Group,
  MultiSelect,
  Select,
  Stack,
  Text,
  Textarea,
  TextInput,
} from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState, type ReactNode } from "react";
import { useAnalyst, useSignature } from "../../api/analyst";
import { freezeFigure } from "../../api/commands";
import { Link } from "@tanstack/react-router";
import {
  globalModelVersionQuery,
  predictionsQuery,
  proposalEvidenceQuery,
  runsQuery,
  structureVersionsQuery,
} from "../../api/queries";
import { useMay } from "../../api/roles";
import type { ModelStructure, ProposalRequest } from "../../api/types";
import { useConversion } from "../../api/units";
import { limitsText, typed } from "../../lib/limits";
import {
  figuresOf,
  proposalOf,
  type ProposalDraft,
  type Reference,
} from "../../lib/drafts/proposal";
import { integer } from "../../lib/urlState";
import { NameForm } from "../account/AnalystMenu";
import { LimitsInput } from "./LimitsInput";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import { EvidenceSummary } from "./VoteEvidence";

interface Props {
  structures: ModelStructure[];
  draft: ProposalDraft;
  onChange: (draft: ProposalDraft) => void;
  onSend: (proposal: ProposalRequest) => void;
  sending: boolean;
  label: string;
  footer?: ReactNode;
}

/** Form of a proposal and its evidence. */
export function ProposalForm({ structures, draft, onChange, onSend, ...props }: Props) {
  const name = useAnalyst();
  const signature = useSignature();
  const [freezing, setFreezing] = useState(false);
  const [failed, setFailed] = useState<unknown>(null);
  const set = (part: Partial<ProposalDraft>) => {
    onChange({ ...draft, ...part });
  };
  const own = structures.find((one) => one.id === draft.structure?.id);
  const mayPropose = useMay("analyst", own?.aircraft_id);
  const read = proposalOf(draft, []);
  const fault =
    own !== undefined && !mayPropose
      ? "Proposals need the role analyst in this campaign"
      : "fault" in read
        ? read.fault
        : null;

  const send = async () => {
    setFreezing(true);
    setFailed(null);
    try {
      const frozen = await Promise.all(draft.requests.map(freezeFigure));
      const ids = frozen.map((one) => one.id);
      // Frozen once: a second attempt to send does not freeze them again.
      onChange({ ...draft, requests: [], figures: [...draft.figures, ...ids] });
      const ready = proposalOf(draft, ids);
      if ("proposal" in ready) onSend(ready.proposal);
    } catch (error) {
      setFailed(error);
    } finally {
      setFreezing(false);
    }
  };
  if (name === "") {
    return (
      <Section title="Your name" note="Shown with your proposal.">
        <NameForm />
      </Section>
    );
  }
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        if (fault === null) void send();
      }}
    >
      <div className="stack">
        <div className="halves">
          <Section title="Proposal">
            <Stack gap="sm">
              <TextInput
                label="Title"
                maxLength={200}
                data-testid="proposal-title"
                value={draft.title}
                onChange={(event) => {
                  set({ title: event.currentTarget.value });
                }}
              />
              {draft.globalModel !== null ? (
                <GlobalModelFacts id={draft.globalModel} />
              ) : (
                <>
                  <VersionSelect
                    label="Structure"
                    structures={structures}
                    value={draft.structure}
                    onChange={(structure) => {
                      set({ structure });
                    }}
                  />
                  <VersionSelect
                    label="Changes"
                    description="Structure or version that the proposal replaces, if any"
                    structures={structures.filter(
                      (one) => own === undefined || one.aircraft_id === own.aircraft_id,
                    )}
                    clearable
                    value={draft.changes}
                    onChange={(changes) => {
                      set({ changes });
                    }}
                  />
                  <LimitsInput
                    value={draft.limits}
                    onChange={(limits) => {
                      set({ limits });
                    }}
                  />
                  <RangeOfRuns draft={draft} onChange={set} />
                </>
              )}
            </Stack>
          </Section>
          <Section title="Reason">
            <Stack gap="sm">
              <Textarea
                size="xs"
                label="Reasoning"
                minRows={5}
                autosize
                maxLength={10_000}
                data-testid="proposal-reasoning"
                value={draft.reasoning}
                onChange={(event) => {
                  set({ reasoning: event.currentTarget.value });
                }}
              />
              <Evidence aircraftId={own?.aircraft_id} draft={draft} onChange={set} />
              <EvidencePreview draft={draft} />
            </Stack>
          </Section>
        </div>
        {props.footer}
        {failed !== null && <ProblemAlert error={failed} />}
        <Group gap="md">
          <Button
            type="submit"
            disabled={fault !== null}
            loading={freezing || props.sending}
            data-testid="send-proposal"
          >
            {props.label}
          </Button>
          <Text size="sm" className="quiet">
            {fault ?? signature}
          </Text>
        </Group>
      </div>
    </form>
  );
}

function GlobalModelFacts({ id }: { id: number }) {
  const version = useQuery(globalModelVersionQuery(id));
  return (
    <Loaded query={version} rows={2}>
      {(data) => (
        <Text size="sm">
          <Link to="/global-model/$id" params={{ id }} className="link">
            Global model version {data.version}: {data.label}
          </Link>
          , for the envelope of its {data.runs.length} runs, which are its evidence.
        </Text>
      )}
    </Loaded>
  );
}

/** The range that the attached runs cover, to be used as limits. */
function RangeOfRuns({
  draft,
  onChange,
}: {
  draft: ProposalDraft;
  onChange: (part: Partial<ProposalDraft>) => void;
}) {
  const evidence = useQuery(proposalEvidenceQuery(draft.structure, draft.runs));
  const convert = useConversion();
  if (draft.structure === null || draft.runs.length === 0) {
    return (
      <Text size="xs" className="quiet">
        Attach runs, and the range that they cover is proposed here.
      </Text>
    );
  }
  return (
    <Loaded query={evidence} rows={1}>
      {({ limits }) => (
        <Group gap="xs">
          <Text size="sm">The runs cover {limitsText(limits, convert)}.</Text>
          <Button
            variant="default"
            size="compact-xs"
            data-testid="use-range"
            onClick={() => {
              onChange({ limits: { ...draft.limits, ...typed(limits) } });
            }}
          >
            Use this range
          </Button>
        </Group>
      )}
    </Loaded>
  );
}

/** Evidence that the readers of the proposal will see. */
function EvidencePreview({ draft }: { draft: ProposalDraft }) {
  const evidence = useQuery(proposalEvidenceQuery(draft.structure, draft.runs));
  if (draft.structure === null) return null;
  if (draft.runs.length === 0) {
    return (
      <Text size="sm" c="var(--page-warn)" data-testid="no-evidence">
        No run is attached: votes would have no evidence.
      </Text>
    );
  }
  return <Loaded query={evidence}>{(data) => <EvidenceSummary evidence={data} />}</Loaded>;
}

interface VersionProps {
  label: string;
  description?: string;
  structures: ModelStructure[];
  clearable?: boolean;
  value: Reference | null;
  onChange: (value: Reference | null) => void;
}

function VersionSelect({
  label,
  description,
  structures,
  clearable,
  value,
  onChange,
}: VersionProps) {
  const versions = useQuery({
    ...structureVersionsQuery(value?.id ?? 0),
    enabled: value !== null,
  });
  return (
    <Group gap="xs" align="end" grow preventGrowOverflow={false}>
      <Select
        label={label}
        description={description}
        searchable
        clearable={clearable}
        allowDeselect={false}
        data={structures.map((one) => ({ value: String(one.id), label: one.name }))}
        value={value === null ? null : String(value.id)}
        onChange={(value) => {
          const found = structures.find((one) => one.id === integer(value));
          onChange(found === undefined ? null : { id: found.id, version: found.version });
        }}
      />
      {value !== null && (
        <Select
          aria-label={`Version of ${label.toLowerCase()}`}
          maw={190}
          allowDeselect={false}
          data={(versions.data ?? []).toReversed().map((one) => ({
            value: String(one.version),
            label: `version ${one.version}${one.author === "" ? "" : `, ${one.author}`}`,
          }))}
          value={String(value.version)}
          onChange={(version) => {
            onChange({ id: value.id, version: integer(version) ?? value.version });
          }}
        />
      )}
    </Group>
  );
}

interface EvidenceProps {
  aircraftId: number | undefined;
  draft: ProposalDraft;
  onChange: (part: Partial<ProposalDraft>) => void;
}

function Evidence({ aircraftId, draft, onChange }: EvidenceProps) {
  const found = useQuery(runsQuery({ state: "succeeded", aircraft_id: aircraftId }));
  const predictions = useQuery(predictionsQuery(aircraftId));
  const runs = found.data ?? [];
  const linked = draft.runs.map(
    (id) => runs.find((one) => one.id === id) ?? { id, method: "", maneuver_label: "" },
  );
  const options = [...linked, ...runs.filter((one) => !draft.runs.includes(one.id))].map((one) => ({
    value: String(one.id),
    label: `${one.method} run ${one.id} ${one.maneuver_label}`.trim(),
  }));
  const [comparison] = draft.comparisons;
  const figures = figuresOf(linked);
  return (
    <>
      <MultiSelect
        label="Runs"
        description="Evidence for the proposal"
        searchable
        limit={100}
        data={options}
        value={draft.runs.map(String)}
        onChange={(ids) => {
          const selected = ids.map(Number);
          onChange({
            runs: selected,
            comparisons:
              comparison === undefined || selected.length === 0
                ? []
                : [{ ...comparison, run_ids: selected }],
            requests: draft.requests.filter((specification) =>
              figuresOf(linked.filter((one) => selected.includes(one.id))).some(
                (one) => one.query === specification.query,
              ),
            ),
          });
        }}
      />
      {draft.runs.length > 0 && (
        <MultiSelect
          label="Compared with predictions"
          description="Links the comparison of these runs"
          data={(predictions.data ?? []).map((one) => ({
            value: String(one.id),
            label: one.source,
          }))}
          value={(comparison?.prediction_ids ?? []).map(String)}
          onChange={(ids) => {
            onChange({
              comparisons: [
                { run_ids: draft.runs, prediction_ids: ids.map(Number), coefficient: null },
              ],
            });
          }}
        />
      )}
      <MultiSelect
        label="Figures to freeze"
        description={
          draft.figures.length > 0
            ? `Stored in their present state; ${draft.figures.length} frozen earlier remain`
            : "Stored in their present state, independent of later data changes"
        }
        disabled={draft.runs.length === 0}
        data={figures.map((one) => one.title)}
        value={draft.requests.map((one) => one.title)}
        onChange={(titles) => {
          onChange({ requests: figures.filter((one) => titles.includes(one.title)) });
        }}
      />
    </>
  );
}
