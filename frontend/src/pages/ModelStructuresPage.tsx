import { Button, Group, Select, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useState } from "react";
import { useAddStructure } from "../api/commands";
import { aircraftQuery, modalTablesQuery, structuresQuery } from "../api/queries";
import type { Aircraft, ModelStructure } from "../api/types";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { Sections } from "../components/frame/SectionTabs";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { derivativeNames } from "../lib/derivatives";
import { dateTime } from "../lib/text/format";
import { mayHaveSymmetry } from "../lib/modes";
import { counts } from "../lib/structure";
import { StructureSearch } from "../components/structures/SearchForm";
import { useDraft } from "../lib/drafts/useDraft";
import { integer } from "../lib/urlState";
import type { ModelStructuresView } from "../views";

const route = getRouteApi("/model-structures");

/** List of model structures, and the form of a new one. */
export function ModelStructuresPage() {
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<ModelStructuresView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }) });
  const structures = useQuery(structuresQuery(view.aircraft));
  const aircraft = useQuery(aircraftQuery);
  return (
    <>
      <PageHead
        title="Model structures"
        trail={[
          <Link to="/campaign" className="link" key="campaign">
            Campaign
          </Link>,
        ]}
      />
      <Loaded query={aircraft}>
        {(all) => (
          <Loaded query={structures} rows={8}>
            {(found) => (
              <Sections
                names={["structures", "search"]}
                contents={{
                  structures: [
                    "Model structures",
                    <div className="stack">
                      <Listed structures={found} aircraft={all} />
                      <NewStructure structures={found} aircraft={all} />
                    </div>,
                  ],
                  search: ["Structure search", <StructureSearch view={view} onChange={change} />],
                }}
              />
            )}
          </Loaded>
        )}
      </Loaded>
    </>
  );
}

interface Props {
  structures: ModelStructure[];
  aircraft: Aircraft[];
}

function Listed({ structures, aircraft }: Props) {
  if (structures.length === 0) {
    return (
      <div className="panel">
        <Empty title="No model structure yet">
          A model structure lists the modes, inputs, outputs and derivatives of a model. Create one
          below.
        </Empty>
      </div>
    );
  }
  const of = (one: ModelStructure) => aircraft.find((craft) => craft.id === one.aircraft_id);
  const count = (one: ModelStructure) => {
    const surfaces = of(one)?.surfaces.map((surface) => surface.name) ?? [];
    const { modes, inputs, axis } = one.structure;
    const names = derivativeNames(modes, inputs.length > 0 ? inputs : surfaces, axis);
    return counts(one.structure, names);
  };
  const columns: Column<ModelStructure>[] = [
    {
      key: "name",
      header: "Structure",
      render: (one) => (
        <Link to="/model-structures/$id" params={{ id: one.id }} className="link">
          {one.name}
        </Link>
      ),
    },
    { key: "aircraft", header: "Aircraft", render: (one) => of(one)?.name ?? one.aircraft_id },
    { key: "modes", header: "Modes", render: (one) => one.structure.modes.join(", ") || "rigid" },
    { key: "free", header: "Free", numeric: true, render: (one) => count(one).free },
    { key: "fixed", header: "Fixed", numeric: true, render: (one) => count(one).fixed },
    { key: "absent", header: "Absent", numeric: true, render: (one) => count(one).absent },
    { key: "version", header: "Version", numeric: true, render: (one) => one.version },
    { key: "author", header: "By", render: (one) => one.author || "–" },
    numeric("at", "Changed", (one) => dateTime(one.changed_at ?? one.created_at)),
    { key: "note", header: "Note", wraps: true, render: (one) => one.note },
  ];
  return (
    <div className="panel">
      <DataTable
        label="Model structures"
        testId="structures-table"
        columns={columns}
        rows={structures}
        rowKey={(one) => one.id}
      />
    </div>
  );
}

function NewStructure({ structures, aircraft }: Props) {
  const navigate = route.useNavigate();
  const add = useAddStructure();
  const { draft, setDraft, discard } = useDraft("flexsid.new-structure", { name: "" });
  const { name } = draft;
  const [craft, setCraft] = useState(aircraft[0]?.id);
  const [copied, setCopied] = useState<number>();
  const origin = structures.find((one) => one.id === copied && one.aircraft_id === craft);
  const tables = useQuery({ ...modalTablesQuery(craft ?? 0), enabled: craft !== undefined });
  const modal = tables.data?.find((one) => one.kind === "FEM");
  const symmetric =
    modal?.numbers.filter((_, index) => mayHaveSymmetry(modal.symmetric[index], true)) ?? [];
  return (
    <Section title="New model structure" note="Editable later; every version is stored.">
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (craft === undefined || name.trim() === "") return;
          const structure =
            origin === undefined
              ? { modes: symmetric.slice(0, 2), inputs: [], outputs: [], free: null, fixed: {} }
              : origin.structure;
          add.mutate(
            {
              aircraft_id: craft,
              name: name.trim(),
              note: origin === undefined ? "" : `from ${origin.name}, version ${origin.version}`,
              structure: {
                free_delays: false,
                extra_parameters: [],
                absent: [],
                ...structure,
                axis: "longitudinal",
              },
            },
            {
              onSuccess: (stored) => {
                discard();
                void navigate({
                  to: "/model-structures/$id",
                  params: { id: stored.id },
                  search: {},
                });
              },
            },
          );
        }}
      >
        <Group align="end" gap="sm">
          <TextInput
            label="Name"
            w={260}
            value={name}
            onChange={(event) => {
              setDraft({ name: event.currentTarget.value });
            }}
          />
          <Select
            label="Aircraft"
            allowDeselect={false}
            data={aircraft.map((one) => ({ value: String(one.id), label: one.name }))}
            value={craft === undefined ? null : String(craft)}
            onChange={(id) => {
              setCraft(integer(id));
            }}
          />
          <Select
            label="Copy of"
            w={260}
            placeholder="none: all derivatives free"
            clearable
            data={structures
              .filter((one) => one.aircraft_id === craft)
              .map((one) => ({ value: String(one.id), label: one.name }))}
            value={copied === undefined ? null : String(copied)}
            onChange={(id) => {
              setCopied(integer(id));
            }}
          />
          <Button
            type="submit"
            loading={add.isPending}
            disabled={name.trim() === "" || craft === undefined || !tables.isSuccess}
            data-testid="add-structure"
          >
            Create model structure
          </Button>
        </Group>
        {add.isError && <ProblemAlert error={add.error} />}
      </form>
    </Section>
  );
}
