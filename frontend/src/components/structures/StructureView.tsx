import { Group, SegmentedControl, Select, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import { useState, type ReactNode } from "react";
import {
  predictionsQuery,
  runQuery,
  runsQuery,
  structuresQuery,
  structureVersionsQuery,
} from "../../api/queries";
import type { Aircraft, ModalTable, ModelStructure, StructureVersion } from "../../api/types";
import { derivativeNames } from "../../lib/derivatives";
import { differences, type States, type Structure } from "../../lib/structure";
import { integer } from "../../lib/urlState";
import type { ModelStructureView } from "../../views";
import { CellNumbers } from "../display/CellNumbers";
import { DerivativeChoice } from "../controls/DerivativeChoice";
import { Section } from "../display/Section";
import { StructureDifference } from "./StructureDifference";
import { StructureGrid } from "../new-run/StructureGrid";
import { StructureParts } from "./StructureParts";

const route = getRouteApi("/model-structures/$id");

interface Props {
  record: ModelStructure;
  versions: StructureVersion[];
  aircraft: Aircraft;
  tables: ModalTable[];
  structure: Structure;
  /** Name of the displayed version: `version 2`, `your draft`. */
  title: string;
  readOnly: boolean;
  onChange: (structure: Structure) => void;
  onUndo?: () => void;
  onRedo?: () => void;
  actions?: ReactNode;
}

/** A structure with the numbers of a run in its cells and its difference from another. */
export function StructureView(props: Props) {
  const { record, versions, aircraft, tables, structure, readOnly, onChange } = props;
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<ModelStructureView>) =>
    void navigate({ search: (previous) => ({ ...previous, ...part }), replace: true });
  const [current, setCurrent] = useState<string>();

  const predictions = useQuery(predictionsQuery(record.aircraft_id));
  const runs = useQuery(runsQuery({ structure_id: record.id, state: "succeeded" }));
  const done = runs.data ?? [];
  const shown = view.run ?? done[0]?.id;
  const run = useQuery({ ...runQuery(shown ?? 0), enabled: shown !== undefined });
  const estimates = new Map(run.data?.parameters.map((one) => [one.name, one]));
  const numbers = run.data !== undefined && view.numbers !== "none";

  const other = useOther(view, versions);
  const surfaces = aircraft.surfaces.map((one) => one.name);
  const found = other === undefined ? [] : differences(other.structure, structure, surfaces);
  const before = new Map(found.map((one) => [one.what, one.before]));

  const inputs = structure.inputs.length > 0 ? structure.inputs : surfaces;
  const all = derivativeNames(structure.modes, inputs, structure.axis);
  const set = (states: States) => {
    onChange({ ...structure, ...states });
  };
  return (
    <>
      <Section
        title="Derivatives"
        note={
          run.data === undefined
            ? "Free: estimated. Fixed: held at a value. Absent: zero."
            : `Value, σ, σ in percent and partial F of ${run.data.method} run ${run.data.id}.`
        }
        actions={
          <Group gap="sm">
            <Select
              aria-label="Run of the displayed numbers"
              placeholder="No run of this structure yet"
              w={230}
              data={runOptions(done, run.data)}
              value={shown === undefined ? null : String(shown)}
              onChange={(id) => {
                change({ run: integer(id) });
              }}
            />
            {run.data !== undefined && (
              <SegmentedControl
                aria-label="Numbers"
                data={[
                  { value: "all", label: "Numbers" },
                  { value: "none", label: "States only" },
                ]}
                value={view.numbers ?? "all"}
                onChange={(next) => {
                  change({ numbers: next === "none" ? "none" : undefined });
                }}
              />
            )}
          </Group>
        }
      >
        <StructureGrid
          axis={structure.axis}
          modes={structure.modes}
          inputs={inputs}
          states={structure}
          onChange={set}
          onUndo={props.onUndo}
          onRedo={props.onRedo}
          current={current}
          onCurrent={setCurrent}
          readOnly={readOnly}
          numbers={numbers ? (name) => <CellNumbers parameter={estimates.get(name)} /> : undefined}
          before={(name) => before.get(name)}
        />
        {current !== undefined && all.includes(current) && (
          <DerivativeChoice
            name={current}
            all={all}
            states={structure}
            onChange={set}
            predictions={predictions.data ?? []}
            runs={done}
            readOnly={readOnly}
          />
        )}
      </Section>
      {props.actions}
      <Section title="Modes, channels and instruments">
        <StructureParts
          structure={structure}
          aircraft={aircraft}
          tables={tables}
          readOnly={readOnly}
          onChange={onChange}
        />
      </Section>
      <Section
        title="Difference"
        note="Cells that differ are outlined in the grid."
        actions={<OtherSelect record={record} versions={versions} view={view} onChange={change} />}
      >
        {other === undefined ? (
          <Text size="sm" className="quiet">
            Select another structure or version to compare with.
          </Text>
        ) : (
          <StructureDifference
            found={found}
            before={`${other.name}, version ${other.version}`}
            after={props.title}
          />
        )}
      </Section>
    </>
  );
}

function runOptions(
  done: { id: number; method: string }[],
  shown: { id: number; method: string } | undefined,
) {
  const known = shown === undefined || done.some((one) => one.id === shown.id);
  return [...done, ...(known ? [] : [shown])].map((one) => ({
    value: String(one.id),
    label: `${one.method} run ${one.id}`,
  }));
}

function useOther(view: ModelStructureView, own: StructureVersion[]): StructureVersion | undefined {
  const { against } = view;
  const versions = useQuery({
    ...structureVersionsQuery(against ?? 0),
    enabled: against !== undefined,
  });
  if (against === undefined) return undefined;
  const known = own.some((one) => one.structure_id === against) ? own : (versions.data ?? []);
  return view.against_version === undefined
    ? known.at(-1)
    : known.find((one) => one.version === view.against_version);
}

interface OtherProps {
  record: ModelStructure;
  versions: StructureVersion[];
  view: ModelStructureView;
  onChange: (part: Partial<ModelStructureView>) => void;
}

function OtherSelect({ record, versions, view, onChange }: OtherProps) {
  const structures = useQuery(structuresQuery(record.aircraft_id));
  const own = versions.map((one) => ({
    value: `${record.id} ${one.version}`,
    label: `version ${one.version}${one.author === "" ? "" : ` by ${one.author}`}`,
  }));
  const others = (structures.data ?? [])
    .filter((one) => one.id !== record.id)
    .map((one) => ({ value: `${one.id} ${one.version}`, label: one.name }));
  return (
    <Select
      aria-label="Compare with"
      placeholder="Compare with"
      w={260}
      clearable
      data={[
        { group: "Versions of this", items: own },
        { group: "Other structures", items: others },
      ]}
      value={
        view.against === undefined
          ? null
          : `${view.against} ${view.against_version ?? versions.at(-1)?.version ?? 1}`
      }
      onChange={(value) => {
        const [against, version] = (value ?? "").split(" ");
        onChange({ against: integer(against), against_version: integer(version) });
      }}
    />
  );
}
