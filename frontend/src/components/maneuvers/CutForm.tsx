import { Alert, Button, Group, Select, Stack, TextInput } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { useCut } from "../../api/commands";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";

const AXES = ["longitudinal", "lateral", "combined"] as const;

interface Props {
  flightId: number;
  window: [number, number] | undefined;
  label: string | undefined;
  fta: number | undefined;
  onWindow: (window: [number, number]) => void;
}

/** Form to cut a maneuver from the selected window. */
export function CutForm({ flightId, window, label: offered, fta: number, onWindow }: Props) {
  const [label, setLabel] = useState(offered ?? "");
  const [fta, setFta] = useState(number);
  const [start, setStart] = useState(rounded(window?.[0]));
  const [stop, setStop] = useState(rounded(window?.[1]));
  const [known, setKnown] = useState({ window, offered, number });
  const [axis, setAxis] = useState<(typeof AXES)[number] | null>(null);
  const cut = useCut(flightId);
  if (known.window?.join() !== window?.join()) {
    // A new window from the figure or the address; the other entries remain.
    setKnown({ ...known, window });
    setStart(rounded(window?.[0]));
    setStop(rounded(window?.[1]));
  }
  if (known.offered !== offered || known.number !== number) {
    setKnown({ window, offered, number });
    setLabel(offered ?? "");
    setFta(number);
  }
  const cutOut: [number, number] | undefined =
    start !== undefined && stop !== undefined && stop > start ? [start, stop] : undefined;
  const show = () => {
    if (cutOut !== undefined) onWindow(cutOut);
  };
  const made = cut.data?.[0];
  return (
    <Stack
      gap="xs"
      component="form"
      aria-label="Cut a maneuver"
      onSubmit={(event) => {
        event.preventDefault();
      }}
    >
      <Group gap="xs" grow>
        <NumberField
          label="From [s]"
          value={start}
          onChange={setStart}
          onBlur={show}
          decimalScale={3}
        />
        <NumberField
          label="To [s]"
          value={stop}
          onChange={setStop}
          onBlur={show}
          decimalScale={3}
        />
      </Group>
      <TextInput
        label="Maneuver"
        placeholder="label"
        value={label}
        onChange={(event) => {
          setLabel(event.currentTarget.value);
        }}
      />
      <NumberField
        label="FTA"
        placeholder="none"
        value={fta}
        onChange={setFta}
        allowDecimal={false}
        min={0}
      />
      <Select
        label="Axis"
        placeholder="from the channels"
        data={AXES}
        value={axis}
        onChange={(value) => {
          setAxis(AXES.find((one) => one === value) ?? null);
        }}
        clearable
      />
      <Button
        disabled={cutOut === undefined || label.trim() === ""}
        loading={cut.isPending}
        data-testid="cut-window"
        onClick={() => {
          if (cutOut === undefined) return;
          cut.mutate([
            {
              label: label.trim(),
              start_s: cutOut[0],
              stop_s: cutOut[1],
              fta: fta ?? null,
              axis,
              note: "",
            },
          ]);
        }}
      >
        Cut this window
      </Button>
      {cut.isError && <ProblemAlert error={cut.error} />}
      {made && (
        <Alert color="green" variant="light" role="status">
          <Link to="/maneuvers/$id" params={{ id: made.id }} className="link">
            {made.label}
          </Link>{" "}
          was cut.
        </Alert>
      )}
    </Stack>
  );
}

const rounded = (value: number | undefined): number | undefined =>
  value === undefined ? undefined : Math.round(1000 * value) / 1000;
