import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { usePropose } from "../api/commands";
import { structuresQuery } from "../api/queries";
import type { ModelStructure } from "../api/types";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { ProposalForm } from "../components/decisions/ProposalForm";
import { EMPTY_PROPOSAL, type ProposalDraft } from "../lib/drafts/proposal";
import { useDraft } from "../lib/drafts/useDraft";

const route = getRouteApi("/decisions/new");

/** Propose a model structure for a range of conditions, or a global model. */
export function NewDecisionPage() {
  const structures = useQuery(structuresQuery());
  const view = route.useSearch();
  return (
    <>
      <PageHead
        title={view.global_model === undefined ? "Propose model structure" : "Propose global model"}
        trail={[
          <Link to="/decisions" className="link" key="decisions">
            Decisions
          </Link>,
        ]}
      />
      <Loaded query={structures}>
        {(all) => <Form key={JSON.stringify(view)} structures={all} />}
      </Loaded>
    </>
  );
}

function Form({ structures }: { structures: ModelStructure[] }) {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const propose = usePropose();
  const reference = (id: number | undefined, version: number | undefined) => {
    const found = structures.find((one) => one.id === id);
    return found === undefined ? null : { id: found.id, version: version ?? found.version };
  };
  const { draft, setDraft, discard } = useDraft<ProposalDraft>(
    `flexsid.proposal.${JSON.stringify(view)}`,
    {
      ...EMPTY_PROPOSAL,
      structure: view.global_model === undefined ? reference(view.structure, view.version) : null,
      globalModel: view.global_model ?? null,
      changes: reference(view.changes, view.changes_version),
      runs: view.runs ?? [],
    },
  );
  return (
    <ProposalForm
      structures={structures}
      draft={draft}
      onChange={setDraft}
      sending={propose.isPending}
      label={draft.globalModel === null ? "Propose model structure" : "Propose global model"}
      footer={propose.isError && <ProblemAlert error={propose.error} />}
      onSend={(proposal) => {
        propose.mutate(proposal, {
          onSuccess: ({ id }) => {
            discard();
            void navigate({ to: "/decisions/$id", params: { id }, search: {} });
          },
        });
      }}
    />
  );
}
