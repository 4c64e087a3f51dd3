import { useQuery } from "@tanstack/react-query";
import { useEffect, useState, type RefObject } from "react";
import { healthQuery } from "../../api/queries";
import { assessFreshness, type Freshness } from "../../lib/live/freshness";
import { fixed } from "../../lib/text/format";
import type { Reception } from "./useLiveStream";

/** The page assesses the reception as often as this. [ms] */
const TICK_MS = 250;

const LABELS: Record<Freshness, string> = {
  waiting: "Waiting for data",
  current: "Data current",
  late: "DATA LATE",
  lost: "NO DATA",
  ended: "Stream ended",
};

const SIGNS: Record<Freshness, string> = {
  waiting: "…",
  current: "●",
  late: "▲",
  lost: "✕",
  ended: "■",
};

interface Props {
  reception: RefObject<Reception>;
  hasEnded: boolean;
}

/** Whether data arrive, by word, sign and color, and the time of the recorder. */
export function ReceptionStatus({ reception, hasEnded }: Props) {
  const [now, setNow] = useState({ freshness: "waiting" as Freshness, age_s: "", time_s: "" });
  useEffect(() => {
    const assess = () => {
      const { received_ms, newest_s } = reception.current;
      const freshness = assessFreshness({ received_ms, hasEnded }, Date.now());
      const isStale = freshness === "late" || freshness === "lost";
      setNow({
        freshness,
        age_s: isStale && received_ms !== null ? fixed((Date.now() - received_ms) / 1000, 0) : "",
        time_s: newest_s === null ? "" : fixed(newest_s, 1),
      });
    };
    assess();
    const timer = setInterval(assess, TICK_MS);
    return () => {
      clearInterval(timer);
    };
  }, [reception, hasEnded]);
  const { isError } = useQuery(healthQuery);
  const { freshness, age_s, time_s } = now;
  return (
    <div className="live-reception" data-state={freshness} data-testid="reception">
      <strong role="status">
        <span aria-hidden="true">{SIGNS[freshness]} </span>
        {LABELS[freshness]}
        {isError && freshness !== "ended" && ": server not reachable"}
      </strong>
      {age_s !== "" && <span className="numbers">for {age_s} s</span>}
      {time_s !== "" && (
        <span className="numbers live-clock">
          {time_s} <span className="live-interval">s</span>
        </span>
      )}
    </div>
  );
}
