import { Button, Group, Progress, Text } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { address } from "../../api/client";
import { useCancelJob, useRetryJob } from "../../api/commands";
import { isOver, type Job } from "../../api/types";
import { dateTime, elapsed } from "../../lib/text/format";
import { oneOf, text } from "../../lib/urlState";
import { PARTITIONS, VARIABLES, VARIATIONS } from "../../views";
import { DataTable, type Column } from "../controls/DataTable";
import { stateText } from "./JobWait";
import { ProblemAlert } from "../display/ProblemAlert";
import { printedReport } from "../controls/ReportMenu";
import { StateBadge } from "../runs/RunBadge";

/** Jobs with their progress and actions. */
export function JobTable({ jobs }: { jobs: Job[] }) {
  const cancel = useCancelJob();
  const retry = useRetryJob();
  const columns: Column<Job>[] = [
    { key: "kind", header: "Job", render: (job) => <JobSubject job={job} /> },
    {
      key: "title",
      header: "Of",
      wraps: true,
      render: (job) =>
        job.maneuver_id === null ? (
          job.title
        ) : (
          <Link to="/maneuvers/$id" params={{ id: job.maneuver_id }} className="link">
            {job.title}
          </Link>
        ),
    },
    { key: "state", header: "State", render: (job) => <StateBadge state={job.state} /> },
    { key: "progress", header: "Progress", render: (job) => <JobState job={job} /> },
    {
      key: "took",
      header: "Duration",
      numeric: true,
      render: (job) => elapsed(job.started_at, job.finished_at),
    },
    { key: "author", header: "By", render: (job) => job.author },
    { key: "at", header: "Requested", numeric: true, render: (job) => dateTime(job.created_at) },
    {
      key: "log",
      header: "",
      render: (job) => (
        <Group gap={6} wrap="nowrap" justify="flex-end">
          <Link to="/jobs/$id" params={{ id: job.id }} className="link">
            Log
          </Link>
          {!isOver(job.state) && (
            <Button
              variant="default"
              size="compact-xs"
              aria-label={`Cancel job ${job.id}`}
              onClick={() => {
                cancel.mutate(job.id);
              }}
            >
              Cancel
            </Button>
          )}
          {(job.state === "failed" || job.state === "cancelled") && (
            <Button
              variant="default"
              size="compact-xs"
              aria-label={`Retry job ${job.id}`}
              onClick={() => {
                retry.mutate(job.id);
              }}
            >
              Retry
            </Button>
          )}
        </Group>
      ),
    },
  ];
  return (
    <>
      {cancel.isError && <ProblemAlert error={cancel.error} />}
      {retry.isError && <ProblemAlert error={retry.error} />}
      <DataTable
        label="Jobs"
        testId="jobs-table"
        columns={columns}
        rows={jobs}
        rowKey={(job) => job.id}
      />
    </>
  );
}

const KINDS: Record<string, string> = {
  "structure-search": "Model structure search",
  "excitation-design": "Excitation design",
  "preflight-simulation": "Pre-flight simulation",
  "flutter-prediction": "Flutter prediction",
  "predicted-flutter": "Flutter of a prediction",
  "closed-loop": "Closed loop",
  "global-model": "Global model",
  "cross-prediction": "Cross-prediction",
  "cross-validation": "Cross-validation",
  "aerodynamics-comparison": "Comparison of aerodynamics",
  "posterior-check": "Posterior check",
  compatibility: "Compatibility of sensors",
  "transfer-function": "Transfer function",
  "output-only-modes": "Output-only modes",
  "predicted-accuracy": "Predicted accuracy",
  "input-comparison": "Comparison with classic inputs",
  "amplitude-optimisation": "Amplitude optimisation",
  "optimal-design": "Optimal design",
  "motion-reconstruction": "Motion reconstruction",
  "mode-identification": "Mode identification",
  "response-estimation": "Frequency responses",
  orthogonality: "Orthogonality",
  "quality-assessment": "Quality assessment",
  import: "Import",
  "derivative-prediction": "Derivative prediction",
  report: "PDF report",
  backup: "Backup",
};

/** Kind of a job, with a link to what it works on. */
function JobSubject({ job }: { job: Job }) {
  const request = job.request ?? {};
  const id = (key: string) => Number(request[key]);
  if (job.run_id !== null) {
    return (
      <Link to="/runs/$id" params={{ id: job.run_id }} className="link">
        {job.method} run {job.run_id}
      </Link>
    );
  }
  const label = KINDS[job.kind] ?? job.kind;
  switch (job.kind) {
    case "structure-search":
      return (
        <Link
          to="/model-structures"
          search={{ id: id("search_id") }}
          hash="search"
          className="link"
        >
          {label}
        </Link>
      );
    case "excitation-design":
      return typeof job.result?.design_id === "number" ? (
        <Link to="/excitation/$id" params={{ id: job.result.design_id }} className="link">
          {label}
        </Link>
      ) : (
        label
      );
    case "report":
    case "backup":
      return job.state === "succeeded" ? (
        <a
          href={job.kind === "report" ? printedReport(job.id) : address(`backups/${job.id}`)}
          target="_blank"
          rel="noopener"
          className="link"
        >
          {label}
        </a>
      ) : (
        label
      );
    case "import":
      return (
        <Link to="/import" search={{ upload: String(request.upload_id) }} className="link">
          {label}
        </Link>
      );
    case "derivative-prediction":
      return (
        <Link to="/aircraft" hash="predictions" className="link">
          {label}
        </Link>
      );
    case "preflight-simulation":
    case "predicted-accuracy":
    case "input-comparison":
    case "amplitude-optimisation":
    case "optimal-design":
      return (
        <Link to="/excitation/$id" params={{ id: id("design_id") }} className="link">
          {label}
        </Link>
      );
    case "flutter-prediction":
      return (
        <Link
          to="/flutter"
          search={{
            ...flutterSearch(request),
            next: readNumber(request, "next_m_s"),
          }}
          className="link"
        >
          {label}
        </Link>
      );
    case "predicted-flutter":
      return (
        <Link to="/flutter" search={{ prediction: id("prediction_id") }} className="link">
          {label}
        </Link>
      );
    case "aerodynamics-comparison":
    case "posterior-check":
      return (
        <Link
          to="/runs/$id"
          params={{ id: id("run_id") }}
          search={{ tab: "checks" }}
          hash={job.kind === "posterior-check" ? "posterior" : "aerodynamics"}
          className="link"
        >
          {label}
        </Link>
      );
    case "transfer-function":
      return (
        <Link
          to="/maneuvers/$id"
          params={{ id: id("maneuver_id") }}
          search={{
            tab: "bode",
            from_input: text(request.input),
            to_output: text(request.output),
            zeros: readNumber(request, "zeros"),
            poles: readNumber(request, "poles"),
            integrators: readNumber(request, "integrators"),
            no_delay: request.delay === false ? true : undefined,
            low: readNumber(request, "low_hz"),
            high: readNumber(request, "high_hz"),
          }}
          hash="transfer-function"
          className="link"
        >
          {label}
        </Link>
      );
    case "output-only-modes":
      return (
        <Link
          to="/maneuvers/$id"
          params={{ id: id("maneuver_id") }}
          search={{
            tab: "bode",
            from: readNumber(request, "start_s"),
            to: readNumber(request, "stop_s"),
            low: readNumber(request, "low_hz"),
            high: readNumber(request, "high_hz"),
          }}
          hash="output-only"
          className="link"
        >
          {label}
        </Link>
      );
    case "compatibility":
      return (
        <Link
          to="/maneuvers/$id"
          params={{ id: (request.maneuver_ids as number[])[0] ?? 0 }}
          search={{ tab: "quality" }}
          hash="compatibility"
          className="link"
        >
          {label}
        </Link>
      );
    case "closed-loop":
      return (
        <Link
          to="/flutter"
          search={{
            tab: "closed-loop",
            ...flutterSearch(request.flutter as Record<string, unknown>),
            controller: id("controller_id"),
          }}
          className="link"
        >
          {label}
        </Link>
      );
    case "global-model":
      return (
        <Link
          to="/global-model"
          search={{
            runs: request.run_ids as number[],
            variables: (request.variables as string[]).flatMap(
              (one) => oneOf(one, VARIABLES) ?? [],
            ),
            prediction: readNumber(request, "prediction_id"),
          }}
          className="link"
        >
          {label}
        </Link>
      );
    case "cross-prediction": {
      const maneuvers = request.maneuver_ids as number[];
      return (
        <Link
          to="/compare"
          search={{
            tab: "validation",
            runs: request.run_ids as number[],
            maneuvers: maneuvers.length > 0 ? maneuvers : undefined,
          }}
          className="link"
        >
          {label}
        </Link>
      );
    }
    case "cross-validation":
      return (
        <Link
          to="/compare"
          search={{
            tab: "validation",
            runs: [id("run_id")],
            partition: oneOf(request.partition, PARTITIONS),
            folds: id("folds"),
          }}
          className="link"
        >
          {label}
        </Link>
      );
    case "motion-reconstruction": {
      const modes = request.modes as number[];
      return (
        <Link
          to="/maneuvers/$id"
          params={{ id: id("maneuver_id") }}
          search={{ tab: "reconstruction", modes: modes.length > 0 ? modes : undefined }}
          className="link"
        >
          {label}
        </Link>
      );
    }
    case "response-estimation":
      return (
        <Link
          to="/modal-data"
          search={{ tab: "gvt", responses: readNumber(job.result ?? {}, "responses_id") }}
          className="link"
        >
          {label}
        </Link>
      );
    case "orthogonality":
      return (
        <Link to="/modal-data" search={{ tab: "files", orthogonality: job.id }} className="link">
          {label}
        </Link>
      );
    case "mode-identification":
      return (
        <Link
          to="/modal-data"
          search={{
            tab: "gvt",
            responses: id("responses_id"),
            from_hz: readNumber(request, "low_hz"),
            to_hz: readNumber(request, "high_hz"),
            order: id("order"),
            poles: readNumbers(request, "poles"),
          }}
          className="link"
        >
          {label}
        </Link>
      );
    case "quality-assessment":
      return (
        <Link
          to="/maneuvers/$id"
          params={{ id: id("maneuver_id") }}
          search={{ tab: "quality" }}
          className="link"
        >
          {label}
        </Link>
      );
    default:
      return label;
  }
}

function readNumbers(query: Record<string, unknown>, key: string): number[] | undefined {
  const value = query[key];
  return Array.isArray(value) && value.length > 0 ? (value as number[]) : undefined;
}

function readNumber(query: Record<string, unknown>, key: string): number | undefined {
  const value = query[key];
  return typeof value === "number" ? value : undefined;
}

/** Search parameters of the pages that show a flutter query; fuel in percent. */
function flutterSearch(query: Record<string, unknown>) {
  const fuel = readNumber(query, "fuel");
  return {
    runs: query.run_ids as number[],
    fuel: fuel === undefined ? undefined : Number((100 * fuel).toPrecision(12)),
    altitude: readNumber(query, "altitude_m"),
    unmodelled_modes:
      query.unmodelled_modes === "residualized" ? ("residualized" as const) : undefined,
    variation: VARIATIONS.find((one) => one === query.variation),
  };
}

function JobState({ job }: { job: Job }) {
  if (job.state === "failed") {
    return (
      <Text size="sm" truncate maw={360} title={job.error?.message}>
        {job.error?.message ?? ""}
      </Text>
    );
  }
  if (isOver(job.state)) return null;
  return (
    <Group gap="xs" wrap="nowrap">
      {job.state === "running" && (
        <Progress value={100 * (job.progress?.fraction ?? 0)} w={120} aria-label="Progress" />
      )}
      <Text size="xs" className="quiet">
        {stateText(job)}
      </Text>
    </Group>
  );
}
