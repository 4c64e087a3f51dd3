import { Alert, Button, Group } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useMemo } from "react";
import { useStopStream } from "../api/commands";
import { streamQuery } from "../api/queries";
import type { LiveStreamDetail } from "../api/types";
import { ControlRoom } from "../components/live/ControlRoom";
import { LiveBode } from "../components/live/LiveBode";
import { LiveAlarms } from "../components/live/LiveAlarms";
import { ReceptionStatus } from "../components/live/ReceptionStatus";
import { TestPoints, TestPointStrip } from "../components/live/TestPointStrip";
import { useLiveStream } from "../components/live/useLiveStream";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { ReportMenu } from "../components/controls/ReportMenu";
import { Section } from "../components/display/Section";
import { firstLook } from "../lib/channels";
import { useDarkByDefault } from "../lib/figures/colorScheme";

const route = getRouteApi("/live/$id");

/** A stream while it is flown: strip charts, modes, flutter speed and alarms. */
export function LiveStreamPage() {
  const { id } = route.useParams();
  useDarkByDefault();
  const stream = useQuery(streamQuery(id));
  return (
    <Loaded query={stream} page={`Stream ${id}`}>
      {(detail) => <Stream key={id} detail={detail} />}
    </Loaded>
  );
}

function Stream({ detail }: { detail: LiveStreamDetail }) {
  const { stream, header, test_points } = detail;
  const view = route.useSearch();
  const navigate = route.useNavigate();
  const change = (next: Partial<typeof view>) =>
    void navigate({ search: { ...view, ...next }, replace: true });
  const channels = useMemo(() => header?.channels ?? [], [header]);
  const shown =
    view.channels ?? (detail.default_channels === null ? [] : firstLook(detail.default_channels));
  const { samples, states, alarms, reception, receiver } = useLiveStream(detail, shown);
  const stop = useStopStream(stream.id);
  const hasEnded = stream.status !== "running";
  const state = states.at(-1) ?? null;
  return (
    <>
      <PageHead
        title={stream.title}
        trail={[
          <Link to="/live" className="link" key="live">
            Live
          </Link>,
        ]}
        actions={
          <Group gap="xs">
            <ReportMenu of={`sortie/${stream.id}`} />
            {!hasEnded && (
              <Button
                variant="default"
                loading={stop.isPending}
                data-testid="stop-stream"
                onClick={() => {
                  stop.mutate();
                }}
              >
                Stop stream
              </Button>
            )}
          </Group>
        }
      />
      <LiveAlarms
        streamId={stream.id}
        title={stream.title}
        alarms={alarms}
        acknowledgements={detail.acknowledgements}
        limits={stream.limits}
        channels={channels}
      />
      {stop.isError && <ProblemAlert error={stop.error} />}
      {stream.status === "failed" && (
        <Alert color="red" variant="light" title="Stream failed" mb="md" data-testid="failed">
          {stream.message}
        </Alert>
      )}
      <div className="live-head">
        <TestPointStrip
          phase={hasEnded ? null : (state?.phase ?? null)}
          last={test_points.at(-1) ?? null}
        />
        <ReceptionStatus reception={reception} hasEnded={hasEnded} />
      </div>
      <ControlRoom
        channels={channels}
        shown={shown}
        onShown={(names) => {
          change({ channels: names });
        }}
        limits={stream.limits}
        next_m_s={stream.next_airspeed_m_s}
        expected={detail.expected_std_errors}
        samples={samples}
        states={states}
        receiver={hasEnded ? null : receiver}
        hasEnded={hasEnded}
        bode={
          <LiveBode
            streamId={stream.id}
            outputs={detail.outputs}
            inputs={detail.inputs}
            output={view.output}
            input={view.input}
            onChange={change}
            time_s={state?.estimate?.time_s ?? null}
            hasEnded={hasEnded}
          />
        }
      >
        {test_points.length > 0 && (
          <Section title="Test points">
            <TestPoints points={test_points} />
          </Section>
        )}
      </ControlRoom>
    </>
  );
}
