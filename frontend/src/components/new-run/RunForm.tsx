import { Button, Group, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState, type ReactNode } from "react";
import { modalTableQuery } from "../../api/queries";
import type { Maneuver, ModalTable, Prediction } from "../../api/types";
import { excitedInputs } from "../../lib/channels";
import { derivativeNames } from "../../lib/derivatives";
import { draftFault, statesOf, withStates, type RunDraft } from "../../lib/drafts/runDraft";
import type { States } from "../../lib/structure";
import { integer } from "../../lib/urlState";
import { AdvancedSettings } from "./AdvancedSettings";
import { useUndo } from "../../lib/drafts/useUndo";
import { DerivativeChoice } from "../controls/DerivativeChoice";
import { Loaded } from "../display/Loaded";
import { MethodPicker } from "../controls/MethodPicker";
import { ModeChecklist } from "../controls/ModeChecklist";
import { RunData } from "../runs/RunData";
import { Section } from "../display/Section";
import { StructureGrid } from "./StructureGrid";

interface Props {
  maneuver: Maneuver;
  outputs: string[];
  tables: ModalTable[];
  predictions: Prediction[];
  draft: RunDraft;
  /** Whether there is an earlier run whose estimates can be the start. */
  fromRun: boolean;
  onChange: (draft: RunDraft) => void;
  /** Content below the form: number of runs, problems. */
  footer: ReactNode;
  submitting: boolean;
  onSubmit: () => void;
}

/** All settings of a run on one page, with defaults that can be submitted. */
export function RunForm({ maneuver, tables, predictions, draft, onChange, ...props }: Props) {
  const set = (part: Partial<RunDraft>) => {
    onChange({ ...draft, ...part });
  };
  const table = useQuery({
    ...modalTableQuery(draft.modalTable ?? 0),
    enabled: draft.modalTable !== null,
  });
  const inputs = draft.inputs.length > 0 ? draft.inputs : excitedInputs(maneuver);
  const fault = draftFault(draft);
  const [current, setCurrent] = useState<string>();
  const all = derivativeNames(draft.modes, inputs, draft.axis);
  const states = statesOf(draft, inputs);
  const { set: setWhole, undo, redo } = useUndo(draft, onChange);
  const setStates = (next: States) => {
    setWhole(withStates(draft, inputs, next));
  };
  const tablesOf = (kind: ModalTable["kind"]) =>
    tables
      .filter((one) => one.kind === kind)
      .map((one) => ({ value: String(one.id), label: one.name }));

  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        if (fault === null) props.onSubmit();
      }}
    >
      <Stack gap="md">
        <Section title="Method" note="One run per selected method.">
          <MethodPicker
            value={draft.methods}
            onChange={(methods) => {
              set({ methods });
            }}
          />
        </Section>
        <div className="halves">
          <Section title="Modes" note="In-vacuo frequencies at the fuel of this maneuver.">
            {draft.modalTable === null ? (
              <Text size="sm" className="quiet">
                This aircraft has no modal table yet; the model is rigid.
              </Text>
            ) : (
              <Loaded query={table} rows={6}>
                {(modal) => (
                  <ModeChecklist
                    table={modal}
                    axis={draft.axis}
                    fuel={maneuver.condition.fuel_fraction}
                    value={draft.modes}
                    onChange={(modes) => {
                      set({ modes });
                    }}
                  />
                )}
              </Loaded>
            )}
            <Group grow mt="sm">
              <Select
                label="Frequencies and shapes"
                data={tablesOf("FEM")}
                value={draft.modalTable === null ? null : String(draft.modalTable)}
                onChange={(id) => {
                  set({ modalTable: integer(id) ?? null });
                }}
              />
              <Select
                label="Damping"
                placeholder="as in the FEM"
                clearable
                data={tablesOf("GVT")}
                value={draft.dampingTable === null ? null : String(draft.dampingTable)}
                onChange={(id) => {
                  set({ dampingTable: integer(id) ?? null });
                }}
              />
            </Group>
          </Section>
          <RunData
            maneuver={maneuver}
            outputs={props.outputs}
            predictions={predictions}
            draft={draft}
            fromRun={props.fromRun}
            onChange={set}
          />
        </div>
        <Section title="Derivatives" note="Free: estimated. Fixed: held at a value. Absent: zero.">
          <StructureGrid
            axis={draft.axis}
            modes={draft.modes}
            inputs={inputs}
            states={states}
            onChange={setStates}
            onUndo={undo}
            onRedo={redo}
            current={current}
            onCurrent={setCurrent}
          />
          {current !== undefined && all.includes(current) && (
            <DerivativeChoice
              name={current}
              all={all}
              states={states}
              onChange={setStates}
              predictions={predictions}
              runs={[]}
            />
          )}
        </Section>
        <AdvancedSettings draft={draft} outputs={props.outputs} onChange={set} />
        {props.footer}
        <Group gap="md">
          <Button
            type="submit"
            size="sm"
            disabled={fault !== null}
            loading={props.submitting}
            data-testid="submit-run"
          >
            {draft.methods.length > 1 ? `Submit ${draft.methods.length} methods` : "Submit run"}
          </Button>
          {fault !== null && (
            <Text size="sm" c="var(--page-warn)">
              {fault}
            </Text>
          )}
        </Group>
      </Stack>
    </form>
  );
}
