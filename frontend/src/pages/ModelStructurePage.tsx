import { Badge, Button, Group, Select, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useEffect } from "react";
import { useAnalyst } from "../api/analyst";
import { useEditStructure, useMarkSeen } from "../api/commands";
import { ApiProblem } from "../api/problem";
import {
  aircraftQuery,
  modalTablesQuery,
  structureQuery,
  structureVersionsQuery,
} from "../api/queries";
import type {
  Aircraft,
  ModalTable,
  ModelStructure,
  StaleStructure,
  StructureVersion,
} from "../api/types";
import { ButtonLink } from "../components/controls/ButtonLink";
import { Loaded } from "../components/display/Loaded";
import { ManeuverSelect } from "../components/maneuvers/ManeuverSelect";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { StructureConflict } from "../components/new-run/StructureConflict";
import { StructureView } from "../components/structures/StructureView";
import { dateTime } from "../lib/text/format";
import { differences, type Structure } from "../lib/structure";
import { integer } from "../lib/urlState";
import { useDraft } from "../lib/drafts/useDraft";
import { useUndo } from "../lib/drafts/useUndo";

const route = getRouteApi("/model-structures/$id");

/** One model structure: the newest version is editable, older ones are read-only. */
export function ModelStructurePage() {
  const { id } = route.useParams();
  const record = useQuery(structureQuery(id));
  return (
    <Loaded query={record} page={`Structure ${id}`}>
      {(data) => <WithParts key={id} record={data} />}
    </Loaded>
  );
}

function WithParts({ record }: { record: ModelStructure }) {
  const name = useAnalyst();
  const { mutate: markSeen } = useMarkSeen();
  useEffect(() => {
    if (name !== "") markSeen({ subject: "structure", id: record.id });
  }, [name, record.id, record.version, markSeen]);
  const { version } = route.useSearch();
  const versions = useQuery(structureVersionsQuery(record.id));
  const aircraft = useQuery(aircraftQuery);
  const tables = useQuery(modalTablesQuery(record.aircraft_id));
  return (
    <Loaded query={versions}>
      {(all) => (
        <Loaded query={tables}>
          {(modal) => (
            <Loaded query={aircraft}>
              {(crafts) => {
                const own = crafts.find((one) => one.id === record.aircraft_id);
                if (own === undefined) return null;
                const old = all.find((one) => one.version === version);
                const parts = { record, versions: all, aircraft: own, tables: modal };
                return old !== undefined && old.version < record.version ? (
                  <Old {...parts} old={old} />
                ) : (
                  <Editor {...parts} />
                );
              }}
            </Loaded>
          )}
        </Loaded>
      )}
    </Loaded>
  );
}

interface Parts {
  record: ModelStructure;
  versions: StructureVersion[];
  aircraft: Aircraft;
  tables: ModalTable[];
}

function Old({ old, ...parts }: Parts & { old: StructureVersion }) {
  return (
    <>
      <Head {...parts} shown={old} unsaved={false} />
      <div className="stack">
        <Text size="sm" className="quiet">
          Version {old.version} of {parts.record.version}, saved {dateTime(old.created_at)}
          {old.author !== "" && ` by ${old.author}`}
          {old.note !== "" && `: ${old.note}`}. Read-only; runs can use it.
        </Text>
        <StructureView
          {...parts}
          structure={old.structure}
          title={`version ${old.version}`}
          readOnly
          onChange={() => undefined}
        />
      </div>
    </>
  );
}

interface Draft {
  structure: Structure;
  name: string;
  note: string;
  /** Version that was edited. */
  version: number;
}

function Editor(parts: Parts) {
  const { record, versions, aircraft } = parts;
  const surfaces = aircraft.surfaces.map((one) => one.name);
  const edit = useEditStructure(record.id);
  const newest: Draft = {
    structure: record.structure,
    name: record.name,
    note: "",
    version: record.version,
  };
  const stored = useDraft<Draft>(`flexsid.structure.${record.id}`, newest);
  const base = versions.find((one) => one.version === stored.draft.version);
  const changed =
    base === undefined ||
    base.name !== stored.draft.name ||
    differences(base.structure, stored.draft.structure, surfaces).length > 0;
  // A draft without changes follows the versions that others save.
  const draft = changed ? stored.draft : { ...newest, note: stored.draft.note };
  const { set, undo, redo, canUndo } = useUndo(draft, stored.setDraft);
  const stale = staleOf(edit.error);

  const save = () => {
    edit.mutate(
      {
        name: draft.name,
        note: draft.note,
        version: draft.version,
        structure: { ...cleaned(draft.structure), axis: "longitudinal" },
      },
      {
        onSuccess: ({ structure, name, version }) => {
          stored.setDraft({ structure, name, version, note: "" });
        },
      },
    );
  };
  return (
    <>
      <Head {...parts} shown={versions.at(-1)} unsaved={changed} />
      <div className="stack">
        {stale !== null && (
          <StructureConflict
            stale={stale}
            mine={draft.structure}
            surfaces={surfaces}
            onResolve={(structure) => {
              set({ ...draft, structure, version: stale.current.version });
              edit.reset();
            }}
          />
        )}
        <StructureView
          {...parts}
          structure={draft.structure}
          title={changed ? "your draft" : `version ${record.version}`}
          readOnly={false}
          onChange={(structure) => {
            set({ ...draft, structure });
          }}
          onUndo={undo}
          onRedo={redo}
          actions={
            <form
              className="panel"
              style={{ padding: "10px 16px" }}
              onSubmit={(event) => {
                event.preventDefault();
                save();
              }}
            >
              <Group align="end" gap="sm">
                <TextInput
                  label="Name"
                  w={240}
                  value={draft.name}
                  onChange={(event) => {
                    set({ ...draft, name: event.currentTarget.value });
                  }}
                />
                <TextInput
                  label="Reason for this version"
                  placeholder="Evidence"
                  style={{ flex: 1, minWidth: 200 }}
                  value={draft.note}
                  onChange={(event) => {
                    stored.setDraft({ ...draft, note: event.currentTarget.value });
                  }}
                />
                <Button variant="default" disabled={!canUndo} onClick={undo}>
                  Undo
                </Button>
                <Button
                  variant="default"
                  disabled={!changed}
                  onClick={() => {
                    set(newest);
                    edit.reset();
                  }}
                >
                  Discard
                </Button>
                <Button
                  type="submit"
                  disabled={!changed || draft.name.trim() === ""}
                  loading={edit.isPending}
                  data-testid="save-structure"
                >
                  Save as version {record.version + 1}
                </Button>
              </Group>
              {changed && draft.version < record.version && stale === null && (
                <Text size="sm" role="status" mt={6} data-testid="newer-version">
                  Your draft is based on version {draft.version};{" "}
                  {record.author || "another analyst"} saved version {record.version} meanwhile.
                  Saving shows both beside each other.
                </Text>
              )}
              {edit.isError && stale === null && <ProblemAlert error={edit.error} />}
            </form>
          }
        />
      </div>
    </>
  );
}

interface HeadProps extends Parts {
  shown: StructureVersion | undefined;
  unsaved: boolean;
}

function Head({ record, versions, shown, unsaved }: HeadProps) {
  const navigate = route.useNavigate();
  return (
    <PageHead
      title={record.name}
      trail={[
        <Link to="/model-structures" className="link" key="structures">
          Model structures
        </Link>,
      ]}
      aside={
        <>
          <Select
            aria-label="Version"
            data-testid="structure-version"
            w={250}
            allowDeselect={false}
            data={versions.toReversed().map((one) => ({
              value: String(one.version),
              label: `Version ${one.version}${one.author === "" ? "" : `, ${one.author}`}`,
            }))}
            value={String(shown?.version ?? record.version)}
            onChange={(value) => {
              const version = integer(value);
              void navigate({
                search: (previous) => ({
                  ...previous,
                  version: version === record.version ? undefined : version,
                }),
              });
            }}
          />
          {unsaved && (
            <Badge color="yellow" c="var(--mantine-color-text)" tt="none">
              not saved
            </Badge>
          )}
        </>
      }
      actions={
        <>
          <ButtonLink
            to="/decisions/new"
            search={{
              structure: record.id,
              version: shown?.version,
              ...(shown !== undefined && shown.version > 1
                ? { changes: record.id, changes_version: shown.version - 1 }
                : {}),
            }}
            variant="default"
            data-testid="propose-structure"
          >
            {" "}
            Propose model structure{" "}
          </ButtonLink>
          <ManeuverSelect
            label="New run with this structure"
            placeholder={unsaved ? "Save before running" : "New run of maneuver…"}
            disabled={unsaved}
            onChoose={(id) =>
              void navigate({
                to: "/maneuvers/$id/new-run",
                params: { id },
                search: { structure: record.id, version: shown?.version },
              })
            }
          />
        </>
      }
    />
  );
}

function staleOf(error: unknown): StaleStructure | null {
  return error instanceof ApiProblem && error.code === "stale-edit"
    ? (error.body as StaleStructure)
    : null;
}

/** The structure without empty delays, which the form lists until it is saved. */
function cleaned(structure: Structure): Structure {
  const delays = Object.entries(structure.delays).filter(([, value]) => value !== 0);
  return { ...structure, delays: Object.fromEntries(delays) };
}
