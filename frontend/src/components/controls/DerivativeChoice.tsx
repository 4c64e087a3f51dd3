import { Group, SegmentedControl, Select, Text } from "@mantine/core";
import type { Prediction } from "../../api/types";
import {
  DERIVATIVE_STATES,
  heldAt,
  stateOf,
  withState,
  type DerivativeState,
  type Held,
  type States,
} from "../../lib/structure";
import { DerivativeName } from "../display/DerivativeName";
import { NumberField } from "./NumberField";

interface Props {
  name: string;
  all: readonly string[];
  states: States;
  onChange: (states: States) => void;
  predictions: readonly Prediction[];
  /** Runs whose estimates a derivative can be fixed to. */
  runs: readonly { id: number; method: string }[];
  readOnly?: boolean;
}

/** The state of one derivative, and where it is held when it is fixed. */
export function DerivativeChoice(props: Props) {
  const { name, all, states, onChange, predictions, runs, readOnly = false } = props;
  const state = stateOf(states, name);
  const held = heldAt(states, name);
  const set = (next: DerivativeState, to?: Held) => {
    onChange(withState(states, all, [name], next, to));
  };
  const key = "id" in held ? `${held.source} ${held.id}` : held.source;
  const known = [
    { value: "start", label: "the start of the run" },
    { value: "number", label: "a number" },
    ...predictions
      .filter((one) => one.names.includes(name))
      .map((one) => ({ value: `prediction ${one.id}`, label: one.source })),
    ...runs.map((one) => ({ value: `run ${one.id}`, label: `${one.method} run ${one.id}` })),
  ];
  const sources = known.some((one) => one.value === key)
    ? known
    : [...known, { value: key, label: key }];
  return (
    <Group gap="sm" data-testid="derivative-choice">
      <Text fw={600} miw={70}>
        <DerivativeName name={name} />
      </Text>
      <SegmentedControl
        aria-label={`State of ${name}`}
        data={DERIVATIVE_STATES.map((one) => ({ value: one, label: one }))}
        value={state}
        readOnly={readOnly}
        onChange={(next) => {
          set(DERIVATIVE_STATES.find((one) => one === next) ?? "free");
        }}
      />
      {state === "fixed" && (
        <Select
          aria-label="Fixed to"
          w={260}
          allowDeselect={false}
          readOnly={readOnly}
          data={sources}
          value={key}
          onChange={(value) => {
            const [source = "start", id = "0"] = (value ?? "start").split(" ");
            if (source === "number") set("fixed", { source, value: 0 });
            else if (source === "prediction" || source === "run") {
              set("fixed", { source, id: Number(id) });
            } else set("fixed");
          }}
        />
      )}
      {held.source === "number" && (
        <NumberField
          aria-label={`Value of ${name}`}
          w={130}
          readOnly={readOnly}
          value={held.value}
          onChange={(value) => {
            if (value !== undefined) set("fixed", { source: "number", value });
          }}
        />
      )}
    </Group>
  );
}
