import { useMemo, useRef, useState } from "react";
import { useComputedColorScheme } from "@mantine/core";
import { useConversion } from "../../api/units";
import type { LiveMode, LiveState } from "../../api/types";
import { converted, hertz, percent } from "../../lib/text/format";
import { trackModes } from "../../lib/live/tracks";
import { CopyTable } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Section } from "../display/Section";
import { MODE_COLORS, TrackPlot } from "./TrackPlot";

interface Props {
  states: readonly LiveState[];
  modes: readonly LiveMode[];
  /** From the last seconds only, where a mode is lightly damped. */
  recent: readonly LiveMode[];
  /** Why there is no new estimate; empty where there is one. */
  reason: string;
}

/** Frequency and damping of every mode: the last estimate in large digits, and all of them. */
export function LiveModes({ states, modes, recent, reason }: Props) {
  const table = useRef<HTMLTableElement>(null);
  const [isShowing, setShowing] = useState(false);
  const scheme = useComputedColorScheme("light");
  const damping = useMemo(() => trackModes(states, "damping"), [states]);
  const { name: unit, factor } = useConversion()("Hz");
  const frequency = useMemo(() => trackModes(states, "frequency", hertz(factor)), [states, factor]);
  const order = damping.tracks.map((track) => track.name);
  const colorOf = (name: string) => MODE_COLORS[scheme][order.indexOf(name) % 6];
  return (
    <Section title="Modes" note="Estimates ± 2 standard errors">
      {modes.length > 0 && reason !== "" && (
        <p className="live-reason">No new estimate: {reason}</p>
      )}
      {modes.length === 0 ? (
        <Empty title="No estimate yet">{reason}</Empty>
      ) : (
        <>
          <h3 className="live-caption">
            Damping ratio over time; the aircraft is unstable below zero
          </h3>
          <TrackPlot
            label="Damping ratio of every mode over time, with intervals of 2 standard errors"
            height={200}
            tracks={damping}
            zero
          />
          <div className="table-scroll" role="region" aria-label="Modes" tabIndex={0}>
            <table ref={table} className="live-modes numbers" data-testid="live-modes">
              <thead>
                <tr>
                  <th scope="col">Mode</th>
                  <th scope="col">
                    Damping ratio <span className="unit">[%]</span>
                  </th>
                  <th scope="col">
                    Frequency <span className="unit">[{unit}]</span>
                  </th>
                  <th scope="col">
                    Unstable <span className="unit">[%]</span>
                  </th>
                </tr>
              </thead>
              <tbody>
                {modes.map((mode) => (
                  <tr key={mode.name} data-testid={`mode-${mode.name}`}>
                    <th scope="row">
                      <span
                        className="live-swatch"
                        style={{ background: colorOf(mode.name) }}
                        aria-hidden="true"
                      />
                      {mode.name}
                    </th>
                    <td className="live-digits" data-negative={mode.damping < 0}>
                      {percent(mode.damping, 1)}
                      <Interval>{percentInterval(mode.damping_std)}</Interval>
                      <Recent mode={recent.find((one) => one.name === mode.name)} />
                    </td>
                    <td className="live-digits">
                      {converted(hertz(mode.frequency), factor, 3)}
                      <Interval>
                        {mode.frequency_std === null
                          ? "unknown"
                          : converted(2 * hertz(mode.frequency_std), factor, 3)}
                      </Interval>
                    </td>
                    <td className="live-digits">{percent(mode.instability_probability)}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </div>
          <CopyTable table={table} label="Modes" />
          <details
            onToggle={(event) => {
              setShowing(event.currentTarget.open);
            }}
          >
            <summary>Frequency [{unit}] over time</summary>
            {isShowing && (
              <TrackPlot
                label={`Frequency of every mode [${unit}] over time, with intervals of 2 standard errors`}
                height={170}
                tracks={frequency}
              />
            )}
          </details>
        </>
      )}
    </Section>
  );
}

/** Damping of a lightly damped mode in the last seconds: it may change within a maneuver. */
function Recent({ mode }: { mode: LiveMode | undefined }) {
  if (mode === undefined) return null;
  return (
    <div className="live-recent" data-negative={mode.damping < 0}>
      last seconds {percent(mode.damping, 1)} ± {percentInterval(mode.damping_std)}
    </div>
  );
}

function Interval({ children }: { children: string }) {
  return <span className="live-interval"> ± {children}</span>;
}

const percentInterval = (std: number | null) => (std === null ? "unknown" : percent(2 * std, 1));
