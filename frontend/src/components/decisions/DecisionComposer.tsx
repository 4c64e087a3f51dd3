import { Button, Group, Stack, Text, Textarea } from "@mantine/core";
import { sameName, useAnalyst, useSignature } from "../../api/analyst";
import { useCommentDecision, useVote, useWithdrawDecision } from "../../api/commands";
import { asProblem } from "../../api/problem";
import { useMay } from "../../api/roles";
import { isOpen, type Decision, type Vote } from "../../api/types";
import { useDraft } from "../../lib/drafts/useDraft";
import { NameForm } from "../account/AnalystMenu";
import { DerivativeName } from "../display/DerivativeName";
import { ProblemAlert } from "../display/ProblemAlert";

const VOTES: [Vote, string][] = [
  ["approve", "Approve"],
  ["request-changes", "Request changes"],
  ["reject", "Reject"],
];

/** A button with a sentence, over several lines where the page is narrow. */
const SENTENCE = {
  h: "auto",
  mih: 36,
  py: 6,
  styles: { label: { whiteSpace: "normal" } },
} as const;

const countWarnings = (n: number) => (n === 1 ? "the open warning" : `the ${n} open warnings`);

interface Props {
  decision: Decision;
  /** Revision that was read; a vote on any other is refused. */
  revision: number;
  derivative?: string;
  /** What approval changes; without it a proposal cannot be approved. */
  consequence: string | undefined;
  /** Warnings of the evidence: an approval despite them has a reason of its own. */
  warnings: readonly string[];
}

/** Form to comment, vote or withdraw; a text is required. */
export function DecisionComposer({ decision, revision, derivative, consequence, warnings }: Props) {
  const name = useAnalyst();
  const signature = useSignature();
  const mayWrite = useMay("analyst", decision.aircraft_id);
  const mayReview = useMay("reviewer", decision.aircraft_id);
  const { draft, setDraft } = useDraft(`flexsid.words.${decision.id}`, { text: "", despite: "" });
  const { text, despite } = draft;
  const comment = useCommentDecision(decision.id);
  const vote = useVote(decision.id);
  const withdraw = useWithdrawDecision(decision.id);
  if (name === "") {
    return (
      <Stack gap="xs">
        <Text size="sm">Set your name to comment or vote.</Text>
        <NameForm />
      </Stack>
    );
  }
  if (!mayWrite) {
    return (
      <Text size="sm" className="quiet">
        Comments need the role analyst in this campaign, votes the role reviewer.
      </Text>
    );
  }
  const own = decision.authors.some((author) => sameName(author, name));
  const open = isOpen(decision.state);
  const mayVote = open && mayReview && (!own || decision.rules.own_allowed);
  const empty = text.trim() === "";
  const isWarned = mayVote && warnings.length > 0;
  const busy = comment.isPending || vote.isPending || withdraw.isPending;
  const done = {
    // The event of a comment can arrive before the response, and the next text be typed meanwhile.
    onSuccess: () => {
      setDraft((now) => (now.text === text ? { text: "", despite: "" } : now));
    },
  };
  // A vote on an old revision is explained above the proposal.
  const failed = [comment.error, vote.error, withdraw.error].find(
    (error) => error !== null && asProblem(error).code !== "stale-edit",
  );
  const stale = [vote.error, withdraw.error].some(
    (error) => error !== null && asProblem(error).code === "stale-edit",
  );
  return (
    <Stack gap="xs">
      <Textarea
        size="xs"
        label={
          derivative === undefined ? (
            "Comment"
          ) : (
            <>
              Comment on <DerivativeName name={derivative} />
            </>
          )
        }
        autosize
        minRows={3}
        maxLength={10_000}
        data-testid="comment-text"
        value={text}
        onChange={(event) => {
          setDraft({ text: event.currentTarget.value, despite });
        }}
      />
      {isWarned && (
        <Textarea
          size="xs"
          label={`To approve: why, despite ${countWarnings(warnings.length)}`}
          autosize
          minRows={1}
          maxLength={10_000}
          data-testid="despite-text"
          value={despite}
          onChange={(event) => {
            setDraft({ text, despite: event.currentTarget.value });
          }}
        />
      )}
      <Group gap="xs">
        <Button
          variant="default"
          disabled={empty || busy}
          data-testid="comment"
          onClick={() => {
            comment.mutate({ text, ...(derivative === undefined ? {} : { derivative }) }, done);
          }}
        >
          Comment
        </Button>
        {mayVote &&
          VOTES.map(([value, label]) => (
            <Button
              key={value}
              variant={value === "approve" ? "filled" : "default"}
              disabled={
                empty ||
                busy ||
                (value === "approve" &&
                  (consequence === undefined || (isWarned && despite.trim() === "")))
              }
              data-testid={`vote-${value}`}
              {...(value === "approve" ? SENTENCE : {})}
              onClick={() => {
                vote.mutate({ revision, vote: value, text, despite }, done);
              }}
            >
              {value === "approve" && consequence !== undefined
                ? `${label}: ${consequence}`
                : label}
            </Button>
          ))}
        {open && own && (
          <Button
            variant="default"
            disabled={empty || busy}
            data-testid="withdraw"
            onClick={() => {
              withdraw.mutate({ revision, text }, done);
            }}
          >
            Withdraw
          </Button>
        )}
      </Group>
      <Text size="xs" className="quiet">
        {signature}.{open && !mayReview && " Votes need the role reviewer in this campaign."}
        {open &&
          mayReview &&
          own &&
          !decision.rules.own_allowed &&
          " Authors cannot vote on their own proposal."}
      </Text>
      {stale && (
        <Text size="sm" c="var(--page-warn)" role="alert">
          The proposal was revised before your vote arrived. Read the changes first.
        </Text>
      )}
      {failed !== undefined && <ProblemAlert error={failed} />}
    </Stack>
  );
}
