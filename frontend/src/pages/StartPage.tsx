import { Stack, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import type { ReactNode } from "react";
import {
  maneuverFacetsQuery,
  maneuversQuery,
  runFacetsQuery,
  runListQuery,
  decisionsQuery,
} from "../api/queries";
import type { RunItem } from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { CampaignProgress, useFirstSheet } from "../components/maneuvers/CampaignProgress";
import { GroundTestAlarm } from "../components/frame/GroundTestAlarm";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { StateBadge } from "../components/runs/RunBadge";
import { Section } from "../components/display/Section";
import { TourOffer } from "../components/frame/Tour";
import { useProposedManeuver } from "../components/designs/useProposedManeuver";
import { count, dateMinute } from "../lib/text/format";

const LINES = 6;

/** Start page: running and failed runs, proposals awaiting review, recent data, next step. */
export function StartPage() {
  useFirstSheet();
  const maneuvers = useQuery(maneuverFacetsQuery({}));
  const runs = useQuery(runFacetsQuery({}));
  const inState = (state: string) =>
    runs.data?.choices.state?.find((choice) => choice.value === state)?.count ?? 0;
  const total = maneuvers.data?.total ?? 0;
  const failed = inState("failed");

  return (
    <>
      <PageHead title="Start" actions={<NextStep />} />
      <CampaignProgress />
      <TourOffer />
      <GroundTestAlarm />
      <ol className="way" aria-label="Workflow">
        <Step to="/campaign" name="Campaign" fact={count(total, "maneuver")} />
        <Step to="/runs" name="Runs" fact={`${inState("succeeded")} succeeded`} />
        <Step to="/compare" name="Compare" fact="methods, conditions, predictions" />
        <Step to="/decisions" name="Decisions" fact="approved models by flight condition" />
        <Step to="/flutter" name="Flutter" fact="margin of the next test point" />
      </ol>
      <div className="two">
        <div className="stack">
          <Section title="Running" note={activity(inState("running"), inState("queued"))}>
            <Runs filters={{ state: "running" }} sort="-id" none="No run is running." />
            {inState("queued") > 0 && (
              <Text size="sm" mt="xs">
                <Link to="/jobs" className="link">
                  {count(inState("queued"), "job")} queued
                </Link>
              </Text>
            )}
          </Section>
          <Section title="Awaiting review" note="Open proposals of models">
            <Proposals />
          </Section>
          <Section title="Recent maneuvers" note="Latest imports">
            <NewManeuvers />
          </Section>
        </div>
        <div className="stack">
          <Section
            title="Failed runs"
            note={failed > 0 ? `${count(failed, "run")} failed` : undefined}
          >
            <Runs filters={{ state: "failed" }} sort="-finished_at" none="No run has failed." />
          </Section>
          <Section title="Recent estimates" note="Latest succeeded runs">
            <Runs
              filters={{ state: "succeeded" }}
              sort="-finished_at"
              none="No succeeded runs yet."
            />
          </Section>
        </div>
      </div>
    </>
  );
}

function activity(running: number, queued: number): string | undefined {
  return running + queued === 0 ? undefined : `${running} running, ${queued} queued`;
}

interface StepProps {
  to: "/campaign" | "/runs" | "/compare" | "/decisions" | "/flutter";
  name: string;
  fact: string;
}

function Step({ to, name, fact }: StepProps) {
  return (
    <li>
      <Link to={to}>
        <strong>{name}</strong>
        <span className="quiet numbers">{fact}</span>
      </Link>
    </li>
  );
}

/** Button of the next step: import, estimate or compare. */
function NextStep() {
  const maneuver = useProposedManeuver();
  const newest = useInfiniteQuery(runListQuery({ state: "succeeded" }, "-finished_at", LINES));
  const done = newest.data?.pages[0]?.items ?? [];
  if (maneuver === undefined || newest.data === undefined) return null;
  if (maneuver === null) {
    return (
      <ButtonLink to="/import" data-testid="next-step">
        Import a maneuver
      </ButtonLink>
    );
  }
  // A comparison requires another run of the maneuver, or a prediction.
  const isComparable = (run: RunItem) =>
    run.prediction_id !== null ||
    done.some((other) => other.id !== run.id && other.maneuver_id === run.maneuver_id);
  const last = done.find(isComparable) ?? done[0];
  const same = done.filter((run) => run.maneuver_id === last?.maneuver_id);
  return (
    <>
      {last !== undefined && (
        <ButtonLink
          to="/compare"
          search={{
            runs: same.map((run) => run.id),
            predictions: [...new Set(same.flatMap((run) => run.prediction_id ?? []))],
          }}
          data-testid="next-compare"
        >
          Compare runs of {last.maneuver_label}
        </ButtonLink>
      )}
      {maneuver.n_runs === 0 && (
        <ButtonLink
          variant={last === undefined ? "filled" : "default"}
          to="/maneuvers/$id/new-run"
          params={{ id: maneuver.id }}
          data-testid="next-step"
        >
          Estimate {maneuver.label}
        </ButtonLink>
      )}
    </>
  );
}

interface RunsProps {
  filters: { state: RunItem["state"] };
  sort: string;
  none: string;
}

function Runs({ filters, sort, none }: RunsProps) {
  const list = useInfiniteQuery(runListQuery(filters, sort, LINES));
  return (
    <Loaded query={list} rows={3}>
      {({ pages }) => (
        <Lines
          none={none}
          lines={(pages[0]?.items ?? []).map((run) => ({
            key: run.id,
            what: (
              <>
                <Link to="/runs/$id" params={{ id: run.id }} className="link">
                  {run.method} run {run.id}
                </Link>
                <span className="quiet">
                  {run.maneuver_label}
                  {run.error_code !== null && `, ${run.error_code}`}
                  {run.outcome !== null && `, ${run.outcome}`}
                </span>
              </>
            ),
            when:
              run.finished_at === null ? (
                <StateBadge state={run.state} />
              ) : (
                dateMinute(run.finished_at)
              ),
          }))}
        />
      )}
    </Loaded>
  );
}

function Proposals() {
  const open = useQuery(decisionsQuery({ state: "open" }));
  return (
    <Loaded query={open} rows={2}>
      {(proposals) => (
        <Lines
          none="No open proposals."
          lines={proposals.slice(0, LINES).map((one) => ({
            key: one.id,
            what: (
              <>
                <Link to="/decisions/$id" params={{ id: one.id }} className="link">
                  {one.proposal.title}
                </Link>
                <span className="quiet">{one.model_name}</span>
              </>
            ),
            when: dateMinute(one.created_at),
          }))}
        />
      )}
    </Loaded>
  );
}

function NewManeuvers() {
  const list = useInfiniteQuery(maneuversQuery({}, "-created_at", LINES));
  return (
    <Loaded query={list} rows={3}>
      {({ pages }) => (
        <Lines
          none="No maneuvers yet. Import one, or load the demonstration campaign with flexsid demo."
          lines={(pages[0]?.items ?? []).map((one) => ({
            key: one.id,
            what: (
              <>
                <Link to="/maneuvers/$id" params={{ id: one.id }} className="link">
                  {one.label}
                </Link>
                <span className="quiet">{count(one.n_runs, "run")}</span>
              </>
            ),
            when: dateMinute(one.created_at),
          }))}
        />
      )}
    </Loaded>
  );
}

interface Line {
  key: number;
  what: ReactNode;
  when: ReactNode;
}

function Lines({ lines, none }: { lines: Line[]; none: string }) {
  if (lines.length === 0) {
    return (
      <Text size="sm" className="quiet">
        {none}
      </Text>
    );
  }
  return (
    <Stack component="ul" gap={6} className="lines">
      {lines.map((line) => (
        <li key={line.key}>
          <span className="line-what">{line.what}</span>
          <span className="quiet numbers">{line.when}</span>
        </li>
      ))}
    </Stack>
  );
}
