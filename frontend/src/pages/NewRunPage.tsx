import { Box, SegmentedControl, Select, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useSubmitBatch, useSubmitRuns } from "../api/commands";
import {
  aircraftQuery,
  maneuverQuery,
  modalTablesQuery,
  predictionsQuery,
  runProposalQuery,
  runQuery,
  runTemplatesQuery,
} from "../api/queries";
import type {
  Aircraft,
  Maneuver,
  ModalTable,
  Prediction,
  Run,
  RunProposal,
  RunTemplate,
} from "../api/types";
import { AxisPicker } from "../components/controls/AxisPicker";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { RunForm } from "../components/new-run/RunForm";
import { RunProposalNote } from "../components/new-run/RunProposalNote";
import {
  asAxis,
  batchRequest,
  firstDraft,
  isUnchanged,
  runRequest,
} from "../components/new-run/runRequest";
import { StructureLink } from "../components/structures/StructureLink";
import { useRunOrigin, type RunOrigin } from "../components/new-run/useRunOrigin";
import { windowOf } from "../lib/figures/band";
import { limitsText } from "../lib/limits";
import { excitedInputs, named } from "../lib/channels";
import type { RunDraft } from "../lib/drafts/runDraft";
import { axisNames } from "../lib/derivatives";
import { mayHaveSymmetry } from "../lib/modes";
import { listOutOfBandModes } from "../lib/drafts/runDraft";
import { integer } from "../lib/urlState";
import { useDraft } from "../lib/drafts/useDraft";

const route = getRouteApi("/maneuvers/$id/new-run");

/** Form of new runs: model structure, methods, data and settings. */
export function NewRunPage() {
  const { id } = route.useParams();
  const { template_run: template, run_template, structure, version, axis } = route.useSearch();
  const maneuver = useQuery(maneuverQuery(id));
  return (
    <Loaded query={maneuver} page="New run">
      {(data) => (
        <WithTables
          key={`${id} ${template} ${run_template} ${structure} ${version} ${axis}`}
          maneuver={data}
          template={template}
        />
      )}
    </Loaded>
  );
}

function WithTables({ maneuver, template }: { maneuver: Maneuver; template?: number }) {
  const aircraft = useQuery(aircraftQuery);
  const tables = useQuery(modalTablesQuery(maneuver.aircraft_id));
  const predictions = useQuery(predictionsQuery(maneuver.aircraft_id));
  const before = useQuery({ ...runQuery(template ?? 0), enabled: template !== undefined });
  const view = route.useSearch();
  const templates = useQuery(runTemplatesQuery(maneuver.aircraft_id));
  const begun = useRunOrigin(maneuver.id, view, template);
  const proposal = useQuery({
    ...runProposalQuery(maneuver.id, windowOf(view), view.axis),
    retry: false,
  });
  return (
    <Loaded query={tables}>
      {(modal) => (
        <Loaded query={predictions}>
          {(sources) => (
            <Loaded query={aircraft}>
              {(all) => {
                const own = all.find((one) => one.id === maneuver.aircraft_id);
                const form = (run?: Run) => (
                  <>
                    {proposal.isError && run === undefined && (
                      <ProblemAlert error={proposal.error} />
                    )}
                    <Form
                      maneuver={maneuver}
                      aircraft={own}
                      tables={modal}
                      predictions={sources}
                      template={run}
                      templates={templates.data ?? []}
                      origin={begun.origin}
                      proposal={proposal.data}
                    />
                  </>
                );
                if (begun.loading || proposal.isPending || templates.isPending) return null;
                return template === undefined ? form() : <Loaded query={before}>{form}</Loaded>;
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
  template?: Run;
  templates: RunTemplate[];
  origin?: RunOrigin;
  proposal?: RunProposal;
}

function Form(props: FormProps) {
  const { maneuver, aircraft, tables, predictions, template, templates, origin, proposal } = props;
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const submit = useSubmitRuns();
  const all = useSubmitBatch();
  const band = windowOf(view);
  const runTemplate = templates.find((one) => one.id === view.run_template);
  const { draft, setDraft, discard } = useDraft<RunDraft>(
    `flexsid.new-run.${maneuver.id}.${template?.id ?? ""}.${origin?.structure.id ?? ""}.${band?.join() ?? ""}.${view.axis ?? ""}.${runTemplate?.id ?? ""}.${runTemplate?.revision ?? ""}`,
    firstDraft({
      maneuver,
      tables,
      predictions,
      template,
      runTemplate,
      origin: origin?.structure,
      proposal,
      methods: view.methods,
      band,
    }),
  );
  const outputs = [
    ...(aircraft?.combinations.map((one) => one.name) ?? []),
    ...named(maneuver.channels, "output"),
  ];
  const maneuvers = [
    maneuver.id,
    ...(view.additional_maneuvers ?? []).filter((id) => id !== maneuver.id),
  ];

  const modal = tables.find((one) => one.id === draft.modalTable);
  const isSymmetric = axisNames(draft.axis).symmetry === "symmetric";
  const ofAxis =
    modal?.numbers.filter((_, index) => mayHaveSymmetry(modal.symmetric[index], isSymmetric)) ?? [];
  const predicted = predictions.find((one) => one.id === draft.prediction)?.names ?? [];

  const excited = excitedInputs(maneuver);
  const unchanged = isUnchanged(draft, excited, origin?.structure);

  const eachItsOwn =
    unchanged && origin?.everywhere === true && origin.ofAdditional.size > 0 && view.joint !== true;

  const send = () => {
    const [first, ...others] = maneuvers;
    const separate = view.joint === true && first !== undefined ? [first] : maneuvers;
    const requests = separate.flatMap((id) =>
      draft.methods.map((method) =>
        runRequest(draft, method, id, excitedInputs(maneuver), {
          template,
          runTemplate,
          origin: unchanged ? origin?.structure : undefined,
          outOfBand: listOutOfBandModes(draft, ofAxis, predicted),
          additionalManeuvers: view.joint === true ? others : undefined,
        }),
      ),
    );
    const [shared] = requests;
    if (separate.length > 1 && shared !== undefined) {
      const request = batchRequest(draft, separate, shared);
      all.mutate(eachItsOwn ? { ...request, structures: [] } : request, {
        onSuccess: (batch) => {
          discard();
          void navigate({ to: "/batches/$id", params: { id: batch.id }, search: {} });
        },
      });
      return;
    }
    submit.mutate(requests, {
      onSuccess: (runs) => {
        discard();
        const [run] = runs;
        if (run !== undefined && runs.length === 1) {
          void navigate({ to: "/runs/$id", params: { id: run.id }, search: {} });
        } else {
          void navigate({
            to: "/maneuvers/$id",
            params: { id: maneuver.id },
            search: { tab: "runs" },
          });
        }
      },
    });
  };

  return (
    <>
      <PageHead
        title={template ? `Run ${template.id} again with changes` : "New run"}
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
          <Link to="/maneuvers/$id" params={{ id: maneuver.id }} className="link" key="maneuver">
            {maneuver.label}
          </Link>,
        ]}
        aside={
          <>
            {templates.length > 0 && (
              <Select
                aria-label="Template"
                placeholder="Template"
                clearable
                w={220}
                data-testid="run-template"
                data={templates.map((one) => ({
                  value: String(one.id),
                  label: `${one.name} (${one.method})`,
                }))}
                value={runTemplate === undefined ? null : String(runTemplate.id)}
                onChange={(value) =>
                  void navigate({
                    search: (previous) => ({
                      ...previous,
                      run_template: integer(value ?? undefined),
                    }),
                    replace: true,
                  })
                }
              />
            )}
            <AxisPicker
              maneuver={maneuver.axis}
              value={asAxis(draft.axis)}
              onChange={(axis) =>
                void navigate({
                  search: (previous) => ({ ...previous, axis }),
                  replace: true,
                })
              }
            />
            {maneuvers.length > 1 && (
              <>
                <Text size="sm" className="quiet">
                  and {maneuvers.length - 1} more{" "}
                  {maneuvers.length === 2 ? "maneuver" : "maneuvers"}
                </Text>
                <SegmentedControl
                  aria-label="Runs for several maneuvers"
                  data={[
                    { value: "each", label: "One run per maneuver" },
                    { value: "joint", label: "One run over all maneuvers" },
                  ]}
                  value={view.joint === true ? "joint" : "each"}
                  onChange={(choice) =>
                    void navigate({
                      search: (previous) => ({
                        ...previous,
                        joint: choice === "joint" ? true : undefined,
                      }),
                      replace: true,
                    })
                  }
                />
              </>
            )}
          </>
        }
      />
      {origin !== undefined && (
        <OriginNote origin={origin} unchanged={unchanged} eachItsOwn={eachItsOwn} />
      )}
      {proposal !== undefined && (
        <Box mb="md">
          <RunProposalNote proposal={proposal} modes={draft.modes} />
        </Box>
      )}
      <RunForm
        maneuver={maneuver}
        outputs={[...new Set(outputs)]}
        tables={tables}
        predictions={predictions}
        draft={draft}
        fromRun={template?.state === "succeeded"}
        onChange={setDraft}
        submitting={submit.isPending || all.isPending}
        onSubmit={send}
        footer={
          (submit.isError || all.isError) && <ProblemAlert error={submit.error ?? all.error} />
        }
      />
    </>
  );
}

interface OriginProps {
  origin: RunOrigin;
  unchanged: boolean;
  /** Every maneuver uses the baseline of its own condition. */
  eachItsOwn: boolean;
}

function OriginNote({ origin, unchanged, eachItsOwn }: OriginProps) {
  const { structure, baseline, ofAdditional } = origin;
  return (
    <Text size="sm" mb="md" data-testid="run-origin">
      {unchanged ? "Model structure" : "Changed from"}{" "}
      <StructureLink
        name={structure.name}
        id={structure.structure_id}
        version={structure.version}
      />
      {baseline !== undefined && (
        <>
          , the baseline for {limitsText(baseline.limits)} by{" "}
          <Link to="/decisions/$id" params={{ id: baseline.decision_id }} className="link">
            {baseline.title}
          </Link>
        </>
      )}
      {ofAdditional.size > 0 &&
        (eachItsOwn
          ? `. ${ofAdditional.size} of the further maneuvers use the baselines of their own conditions.`
          : `. ${ofAdditional.size} of the further maneuvers have another baseline.`)}
    </Text>
  );
}
