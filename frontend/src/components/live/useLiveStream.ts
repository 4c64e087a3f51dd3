import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect, useMemo, useRef, useState, type RefObject } from "react";
import { readStreamSamples, streamHistoryQuery } from "../../api/queries";
import { listenToStream } from "../../api/liveStreamEvents";
import type { LiveAlarm, LiveSnapshot, LiveState, LiveStreamDetail } from "../../api/types";
import { addAlarms } from "../../lib/live/alarms";
import { addStates } from "../../lib/live/maneuver";
import { Samples } from "../../lib/live/samples";
import { STRIP_S } from "../../lib/live/strip";

/** What was last received of a stream; read by clocks, so that data do not render the page. */
export interface Reception {
  /** When the newest data arrived, by the clock of the browser. [ms] */
  received_ms: number | null;
  /** End of the newest data by the recorder. [s] */
  newest_s: number | null;
}

/** Samples and states of a stream as they are received; a reload reads what the server has. */
export function useLiveStream(detail: LiveStreamDetail, channels: readonly string[]) {
  const id = detail.stream.id;
  const isRunning = detail.stream.status === "running";
  const cache = useQueryClient();
  const [samples] = useState(() => new Samples());
  const [received, setReceived] = useState<readonly LiveState[]>([]);
  const [raised, setRaised] = useState<readonly LiveAlarm[]>([]);
  const [reported, setReported] = useState<LiveSnapshot["reception"]>(null);
  const reception = useRef<Reception>({ received_ms: null, newest_s: null });
  const names = channels.join(",");

  // What the server has: the maneuver so far, or the last one, and the present state.
  const { snapshot } = detail;
  const history = useQuery(streamHistoryQuery(id, findBegin(detail)));
  const states = useMemo(
    () =>
      addStates(received, [
        ...(history.data?.states.map((one) => one.state) ?? []),
        ...(snapshot?.state ? [snapshot.state] : []),
      ]),
    [received, history.data, snapshot],
  );
  useEffect(() => {
    if (snapshot !== null) note(reception, snapshot);
  }, [snapshot]);

  useEffect(() => {
    if (!isRunning) return;
    let phase: string | null = null;
    const refresh = () => void cache.invalidateQueries({ queryKey: ["stream", id] });
    let hasSamples = false;
    const read = () => {
      if (names === "") return;
      const since = Math.max(0, (reception.current.newest_s ?? 0) - STRIP_S);
      readStreamSamples(id, names, since)
        .then((columns) => {
          samples.append(columns);
        })
        .catch(() => undefined); // the newest follow anyway
    };
    return listenToStream(id, names, {
      onOpen: () => {
        hasSamples = false;
        refresh();
        read();
      },
      onSnapshot: (news) => {
        note(reception, news);
        setReported(news.reception);
        const { state } = news;
        if (state !== null) {
          setReceived((known) => addStates(known, [state]));
          setRaised((known) => addAlarms(known, state.alarms));
        }
        const next = news.state?.phase ?? null;
        // A maneuver that begins or ends changes the test points, too.
        if (phase !== null && next !== phase) refresh();
        phase = next;
      },
      onSamples: (columns) => {
        const last = columns.time_s.at(-1);
        if (last === undefined) return;
        reception.current = { newest_s: last + columns.column_s, received_ms: Date.now() };
        samples.append(columns);
        if (!hasSamples) read(); // what came between the connection and the first of them
        hasSamples = true;
      },
    });
  }, [cache, id, isRunning, names, samples]);

  // Alarms of an earlier maneuver remain until they are acknowledged, in every browser.
  const alarms = useMemo(
    () => addAlarms(addAlarms(detail.alarms, raised), states.at(-1)?.alarms ?? []),
    [detail.alarms, raised, states],
  );
  return { samples, states, alarms, reception, receiver: reported ?? snapshot?.reception ?? null };
}

function note(reception: RefObject<Reception>, { newest_s, silent_s }: LiveSnapshot) {
  if (silent_s !== null)
    reception.current = { newest_s, received_ms: Date.now() - 1000 * silent_s };
}

/** Begin of the present maneuver, or of the last one. [s] */
function findBegin({ snapshot, test_points }: LiveStreamDetail): number | undefined {
  const state = snapshot?.state;
  if (state != null && state.maneuver_s > 0) return Math.floor(state.time_s - state.maneuver_s);
  const last = test_points.at(-1);
  return last === undefined ? undefined : Math.floor(last.start_s);
}
