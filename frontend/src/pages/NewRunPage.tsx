import { Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useSubmitRuns } from "../api/commands";
import {
  aircraftQuery,
  maneuverQuery,
  modalTablesQuery,
  predictionsQuery,
  runQuery,
} from "../api/queries";
import type { Aircraft, Maneuver, ModalTable, Prediction, Run, RunRequest } from "../api/types";
import { Loaded } from "../components/Loaded";
import { PageHead } from "../components/PageHead";
import { ProblemAlert } from "../components/ProblemAlert";
import { RunForm } from "../components/RunForm";
import { excitedInputs, named } from "../lib/channels";
import {
  bandOf,
  EMPTY_DRAFT,
  freeDerivatives,
  holdAllBut,
  STARTS,
  type RunDraft,
} from "../lib/runDraft";
import { useDraft } from "../lib/useDraft";

const route = getRouteApi("/maneuvers/$id/new-run");

/** Choose what to estimate, how, and from which data. */
export function NewRunPage() {
  const { id } = route.useParams();
  const { like } = route.useSearch();
  const maneuver = useQuery(maneuverQuery(id));
  return (
    <Loaded query={maneuver}>
      {(data) => <WithTables key={`${id} ${like ?? ""}`} maneuver={data} like={like} />}
    </Loaded>
  );
}

function WithTables({ maneuver, like }: { maneuver: Maneuver; like?: number }) {
  const aircraft = useQuery(aircraftQuery);
  const tables = useQuery(modalTablesQuery(maneuver.aircraft_id));
  const predictions = useQuery(predictionsQuery(maneuver.aircraft_id));
  const before = useQuery({ ...runQuery(like ?? 0), enabled: like !== undefined });
  return (
    <Loaded query={tables}>
      {(modal) => (
        <Loaded query={predictions}>
          {(sources) => (
            <Loaded query={aircraft}>
              {(all) => {
                const own = all.find((one) => one.id === maneuver.aircraft_id);
                const form = (run?: Run) => (
                  <Form
                    maneuver={maneuver}
                    aircraft={own}
                    tables={modal}
                    predictions={sources}
                    like={run}
                  />
                );
                return like === undefined ? form() : <Loaded query={before}>{form}</Loaded>;
              }}
            </Loaded>
          )}
        </Loaded>
      )}
    </Loaded>
  );
}

interface FormProps {
  maneuver: Maneuver;
  aircraft: Aircraft | undefined;
  tables: ModalTable[];
  predictions: Prediction[];
  like?: Run;
}

function Form({ maneuver, aircraft, tables, predictions, like }: FormProps) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const submit = useSubmitRuns();
  const { draft, setDraft, forget } = useDraft<RunDraft>(
    `flexsid.new-run.${maneuver.id}.${like?.id ?? ""}`,
    firstDraft({ maneuver, tables, predictions, like, methods: view.methods }),
  );
  const outputs = [
    ...(aircraft?.combinations.map((one) => one.name) ?? []),
    ...named(maneuver.channels, "output"),
  ];
  const maneuvers = [maneuver.id, ...(view.also ?? []).filter((id) => id !== maneuver.id)];

  const send = () => {
    const requests = maneuvers.flatMap((id) =>
      draft.methods.map((method) => request(draft, method, id, excitedInputs(maneuver), like)),
    );
    submit.mutate(requests, {
      onSuccess: (runs) => {
        forget();
        const [run] = runs;
        if (run !== undefined && runs.length === 1) {
          void navigate({ to: "/runs/$id", params: { id: run.id }, search: {} });
        } else if (maneuvers.length === 1) {
          void navigate({
            to: "/maneuvers/$id",
            params: { id: maneuver.id },
            search: { tab: "runs" },
          });
        } else void navigate({ to: "/jobs", search: {} });
      },
    });
  };

  return (
    <>
      <PageHead
        title={like ? `Run ${like.id} again with changes` : "New run"}
        trail={[
          <Link to="/" className="link" key="campaign">
            Campaign
          </Link>,
          <Link to="/maneuvers/$id" params={{ id: maneuver.id }} className="link" key="maneuver">
            {maneuver.label}
          </Link>,
        ]}
        aside={
          maneuvers.length > 1 && (
            <Text size="sm" className="quiet">
              and {maneuvers.length - 1} more {maneuvers.length === 2 ? "maneuver" : "maneuvers"}
            </Text>
          )
        }
      />
      <RunForm
        maneuver={maneuver}
        outputs={[...new Set(outputs)]}
        tables={tables}
        predictions={predictions}
        draft={draft}
        fromRun={like?.state === "succeeded"}
        onChange={setDraft}
        submitting={submit.isPending}
        onSubmit={send}
        footer={submit.isError && <ProblemAlert error={submit.error} />}
      />
    </>
  );
}

function request(
  draft: RunDraft,
  method: RunRequest["method"],
  maneuver: number,
  excited: string[],
  like?: Run,
): RunRequest {
  const band = bandOf(draft);
  return {
    author: "",
    maneuver_id: maneuver,
    method,
    structure: {
      modes: draft.modes,
      inputs: draft.inputs,
      outputs: draft.outputs,
      free: freeDerivatives(draft, draft.inputs.length > 0 ? draft.inputs : excited),
      fixed: like?.structure.fixed ?? {},
      free_delays: draft.freeDelays,
      also_free: like?.structure.also_free ?? [],
      axis: "longitudinal",
    },
    settings: {
      start: draft.start,
      band_hz: "band" in band ? band.band : null,
      max_iterations: draft.maxIterations,
      noise: like?.settings.noise === "full" ? "full" : "diagonal",
      start_run_id: draft.start === "run" ? like?.id : null,
      priors: Object.fromEntries(
        Object.entries(like?.settings.priors ?? {}).map(([name, [value = 0, spread = 1]]) => [
          name,
          [value, spread] as [number, number],
        ]),
      ),
      prior_spread: like?.settings.prior_spread ?? null,
      together_with: like?.settings.together_with ?? [],
    },
    modal_table_id: draft.modalTable,
    damping_table_id: draft.dampingTable,
    prediction_id: draft.prediction,
  };
}

interface Beginning extends Omit<FormProps, "aircraft"> {
  methods?: RunDraft["methods"];
}

/** The choices of an earlier run, or defaults that suit the maneuver. */
function firstDraft({ maneuver, tables, predictions, like, methods }: Beginning): RunDraft {
  const modal = tables.find((one) => one.kind === "FEM");
  const sources = {
    modalTable: modal?.id ?? null,
    dampingTable: tables.find((one) => one.kind === "GVT")?.id ?? null,
    prediction: predictions[0]?.id ?? null,
  };
  if (like === undefined) {
    const symmetric = modal?.numbers.filter((_, place) => modal.symmetric[place]) ?? [];
    return {
      ...EMPTY_DRAFT,
      ...sources,
      modes: symmetric.slice(0, 2),
      ...(methods && methods.length > 0 ? { methods } : {}),
    };
  }
  const { structure, settings } = like;
  const draft: RunDraft = {
    methods: [like.method],
    modes: structure.modes,
    inputs: structure.inputs,
    outputs: structure.outputs,
    held: [],
    start: STARTS.find((one) => one === settings.start) ?? "best",
    band: [String(settings.band_hz?.[0] ?? ""), String(settings.band_hz?.[1] ?? "")],
    freeDelays: structure.free_delays,
    maxIterations: settings.max_iterations,
    modalTable: like.modal_table_id ?? sources.modalTable,
    dampingTable: like.damping_table_id,
    prediction: like.prediction_id ?? sources.prediction,
  };
  const inputs = draft.inputs.length > 0 ? draft.inputs : excitedInputs(maneuver);
  return holdAllBut(draft, inputs, structure.free ?? null);
}
