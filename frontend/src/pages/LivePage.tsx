import { Badge } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { streamsQuery } from "../api/queries";
import type { LiveStream } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { StartStream } from "../components/live/StartStream";
import { Loaded } from "../components/display/Loaded";
import { quantity } from "../components/display/Quantity";
import { PageHead } from "../components/frame/PageHead";
import { Section } from "../components/display/Section";
import { dateTime } from "../lib/text/format";
import { tint } from "../lib/figures/tint";

const route = getRouteApi("/live");

const COLORS: Record<LiveStream["status"], string> = {
  running: "blue",
  stopped: "gray",
  failed: "red",
};

const COLUMNS: Column<LiveStream>[] = [
  {
    key: "title",
    header: "Stream",
    render: (stream) => (
      <Link to="/live/$id" params={{ id: stream.id }} className="link">
        {stream.title}
      </Link>
    ),
  },
  {
    key: "status",
    header: "Status",
    render: ({ status, message }) => (
      <Badge
        bg={tint(COLORS[status])}
        c="var(--mantine-color-text)"
        tt="none"
        miw="max-content"
        title={message}
      >
        {status}
      </Badge>
    ),
  },
  { key: "receiver", header: "Receiver", render: (stream) => stream.receiver.name },
  {
    key: "run",
    header: "Settings of",
    render: (stream) => (
      <Link to="/runs/$id" params={{ id: stream.run_id }} className="link">
        Run {stream.run_id}
      </Link>
    ),
  },
  quantity("next", "Next test point", (stream) => stream.next_airspeed_m_s, "m/s", 1),
  { key: "author", header: "By", render: (stream) => stream.author },
  {
    key: "created",
    header: "Started",
    numeric: true,
    render: (stream) => dateTime(stream.created_at),
  },
];

/** Streams of samples while an aircraft flies, and the form that starts one. */
export function LivePage() {
  const { run } = route.useSearch();
  const streams = useQuery(streamsQuery);
  return (
    <>
      <PageHead title="Live" />
      <div className="campaign">
        <Section title="Streams" note="Identification while the aircraft flies, newest first">
          <Loaded query={streams} rows={6}>
            {(rows) =>
              rows.length === 0 ? (
                <Empty title="No streams yet">
                  Start the replay of a stored maneuver, or wait for samples of a network.
                </Empty>
              ) : (
                <DataTable
                  label="Streams"
                  testId="streams-table"
                  columns={COLUMNS}
                  rows={rows}
                  rowKey={(stream) => stream.id}
                />
              )
            }
          </Loaded>
        </Section>
        <aside>
          <Section title="Start a stream">
            <StartStream run={run} />
          </Section>
        </aside>
      </div>
    </>
  );
}
