import { MultiSelect, SegmentedControl, Stack, Switch, Text } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { figureQuery, maneuversQuery, runsQuery } from "../../api/queries";
import { bandOf, overFrequency, windowOf } from "../../lib/figures/band";
import { excitedInputs, offeredChannels } from "../../lib/channels";
import { integers } from "../../lib/urlState";
import { BandBar } from "./BandBar";
import { ChannelPicker } from "../controls/ChannelPicker";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import type { ManeuverTabProps } from "./TimeHistoryTab";
import { BODE_PLANES } from "../../views";

const PLANES = { bode: "Bode", nichols: "Nichols", nyquist: "Nyquist", loops: "Loops" };

interface BlankedPoint {
  output: string;
  input: string;
  frequency_hz: number;
  reason: string;
}

/** Frequency responses from the excited inputs, with the models of runs overlaid. */
export function BodeTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const runs = useQuery(runsQuery({ maneuver_id: maneuver.id, state: "succeeded" }));
  const excited = excitedInputs(maneuver);
  const outputs = view.outputs ?? maneuver.default_channels.rates;
  const inputs = view.inputs ?? excited.slice(0, 3);
  const params = {
    maneuver_id: maneuver.id,
    output: outputs,
    inputs,
    run_id: view.models,
    overlay: view.overlay,
    average: view.average,
    rigid: view.rigid,
    windowed: view.windowed,
    view: view.plane === "loops" ? undefined : view.plane,
    frequency_scale: view.frequency_scale,
    magnitude_scale: view.magnitude_scale,
  };
  const overBand = (view.plane ?? "bode") === "bode";
  const campaign = useInfiniteQuery(maneuversQuery({}, "id", 200));
  const others = (campaign.data?.pages ?? [])
    .flatMap((page) => page.items)
    .filter((item) => item.id !== maneuver.id && item.aircraft_id === maneuver.aircraft_id);
  return (
    <div className="split">
      <Stack gap="md">
        <SegmentedControl
          aria-label="Plane"
          data={BODE_PLANES.map((plane) => ({ value: plane, label: PLANES[plane] }))}
          value={view.plane ?? "bode"}
          onChange={(value) => {
            onChange({ plane: BODE_PLANES.find((plane) => plane === value) });
          }}
        />
        {overBand && <BodeScales view={view} onChange={onChange} />}
        <MultiSelect
          label="Models"
          placeholder={view.models === undefined ? "Measured only" : undefined}
          description="Models overlaid on the measurement"
          clearable
          data-testid="bode-run"
          data={(runs.data ?? [])
            .filter((run) => run.has_model)
            .map((run) => ({
              value: String(run.id),
              label: `${run.method} run ${run.id}, ${run.axis}, modes ${run.modes.join(" ")}`,
            }))}
          value={(view.models ?? []).map(String)}
          onChange={(ids) => {
            onChange({ models: integers(ids) });
          }}
        />
        <Switch
          label="Rigid-body sensors"
          description="Model outputs without elastic sensor motion: C_e = 0"
          disabled={view.models === undefined}
          checked={view.rigid === true}
          onChange={(event) => {
            onChange({ rigid: event.currentTarget.checked || undefined });
          }}
        />
        <MultiSelect
          label="Other maneuvers"
          description="Frequency responses overlaid"
          searchable
          clearable
          data={others.map((item) => ({ value: String(item.id), label: item.label }))}
          value={(view.overlay ?? []).map(String)}
          onChange={(ids) => {
            onChange({ overlay: integers(ids) });
          }}
        />
        <Switch
          label="Average over maneuvers"
          description="Weighted by information"
          disabled={view.overlay === undefined}
          checked={view.average === true}
          onChange={(event) => {
            onChange({ average: event.currentTarget.checked || undefined });
          }}
        />
        <Switch
          label="Averaged windows"
          description="With coherence; always used for sweeps and doublets"
          checked={view.windowed === true || maneuver.excitation === null}
          disabled={maneuver.excitation === null}
          onChange={(event) => {
            onChange({ windowed: event.currentTarget.checked || undefined });
          }}
        />
        <ChannelPicker
          label="Inputs"
          groups={[{ label: "Excited", items: excited.map((name) => ({ name })) }]}
          value={inputs}
          onChange={(names) => {
            onChange({ inputs: names });
          }}
        />
        <ChannelPicker
          label="Outputs"
          groups={offeredChannels(maneuver, ["output"])}
          value={outputs}
          height={300}
          onChange={(names) => {
            onChange({ outputs: names });
          }}
        />
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        {view.plane === "loops" ? (
          <Figure
            kind="loops"
            title="Loop of each surface, broken at its servo with the others closed"
            params={{ maneuver_id: maneuver.id }}
          />
        ) : outputs.length === 0 || inputs.length === 0 ? (
          <Empty title="No channels selected">Select an input and an output on the left.</Empty>
        ) : (
          <>
            {overBand && (
              <BandBar
                maneuverId={maneuver.id}
                window={windowOf(view)}
                onClear={() => {
                  onChange(bandOf(null));
                }}
              />
            )}
            <Figure
              kind="bode"
              title="Frequency responses of the bare airframe"
              params={params}
              revision={[
                outputs,
                inputs,
                view.plane,
                view.frequency_scale,
                view.magnitude_scale,
              ].join("|")}
              {...(overBand ? overFrequency(view, onChange) : {})}
            />
            <NotDrawn params={params} />
          </>
        )}
      </div>
    </div>
  );
}

/** Scales of the Bode plot, as stored in the address. */
function BodeScales({ view, onChange }: Pick<ManeuverTabProps, "view" | "onChange">) {
  return (
    <>
      <Switch
        label="Logarithmic frequencies"
        checked={view.frequency_scale !== "linear"}
        onChange={(event) => {
          onChange({ frequency_scale: event.currentTarget.checked ? undefined : "linear" });
        }}
      />
      <div>
        <Text size="sm" fw={500} mb={4}>
          Magnitude
        </Text>
        <SegmentedControl
          aria-label="Scale of the magnitude"
          fullWidth
          data={[
            { value: "dB", label: "dB" },
            { value: "log", label: "Log" },
            { value: "linear", label: "Linear" },
          ]}
          value={view.magnitude_scale ?? "dB"}
          onChange={(value) => {
            onChange({
              magnitude_scale: value === "log" || value === "linear" ? value : undefined,
            });
          }}
        />
      </div>
    </>
  );
}

/** Omitted data with the reason, and the agreement of averaged maneuvers. */
function NotDrawn({ params }: { params: Parameters<typeof figureQuery>[1] }) {
  const figure = useQuery({
    ...figureQuery("bode", params),
    enabled: String(params.output) !== "" && String(params.inputs) !== "",
  });
  const meta = figure.data?.layout.meta as
    { blanked?: BlankedPoint[]; agreement?: Record<string, number> } | undefined;
  const blanked = meta?.blanked ?? [];
  const agreement = Object.entries(meta?.agreement ?? {});
  return (
    <>
      {agreement.length > 0 && (
        <Text size="xs" className="quiet numbers" px="sm" pb="xs">
          Probability that the maneuvers differ as much by chance:{" "}
          {agreement.map(([input, value]) => `${input} ${value.toPrecision(2)}`).join(", ")}
        </Text>
      )}
      {blanked.length > 0 && (
        <details data-testid="blanked" style={{ fontSize: 12, padding: "0 12px 12px" }}>
          <summary>{blanked.length} points not drawn</summary>
          <ul className="numbers">
            {blanked.map((point) => (
              <li key={[point.output, point.input, point.frequency_hz, point.reason].join(" ")}>
                {point.output} over {point.input} at {point.frequency_hz.toFixed(3)} Hz:{" "}
                {point.reason}
              </li>
            ))}
          </ul>
        </details>
      )}
    </>
  );
}
