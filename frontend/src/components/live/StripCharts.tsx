import { useEffect, useMemo } from "react";
import type { LiveState, StreamChannel } from "../../api/types";
import { describeDefect } from "../../lib/live/health";
import type { Samples } from "../../lib/live/samples";
import { Empty } from "../display/Empty";
import { createDrawingQueue } from "./drawingQueue";
import { StripChart } from "./StripChart";

interface Props {
  channels: readonly StreamChannel[];
  samples: Samples;
  limits: Readonly<Record<string, readonly number[]>>;
  state: LiveState | null;
}

/** Strip charts of the selected channels; drawn when samples arrive, outside React. */
export function StripCharts({ channels, samples, limits, state }: Props) {
  const queue = useMemo(() => createDrawingQueue(), []);
  useEffect(() => {
    const leave = samples.listen(queue.request);
    return () => {
      leave();
      queue.stop();
    };
  }, [samples, queue]);
  if (channels.length === 0) return <Empty title="No channels selected" />;
  return (
    <div className="strips">
      {channels.map(({ name, unit }) => {
        const health = state?.health.find((one) => one.name === name);
        return (
          <StripChart
            key={name}
            name={name}
            unit={unit}
            strip={samples.strip(name)}
            limits={limits[name]}
            queue={queue}
            defect={health === undefined ? undefined : describeDefect(health)}
          />
        );
      })}
    </div>
  );
}
