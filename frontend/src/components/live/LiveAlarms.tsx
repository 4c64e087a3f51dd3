import { Button, Stack, Text } from "@mantine/core";
import { useDocumentTitle } from "@mantine/hooks";
import { useAnalyst } from "../../api/analyst";
import { useAcknowledgeAlarm } from "../../api/commands";
import { useConversion } from "../../api/units";
import type { Acknowledgement, LiveAlarm, StreamChannel } from "../../api/types";
import { fixed, significant } from "../../lib/text/format";
import { alarmKey, splitAlarms } from "../../lib/live/alarms";
import { NameForm } from "../account/AnalystMenu";
import { ProblemAlert } from "../display/ProblemAlert";

const KINDS: Record<LiveAlarm["kind"], string> = {
  unstable: "Unstable mode",
  "next point": "Flutter below the next test point",
  limit: "Limit exceeded",
};

interface Props {
  streamId: number;
  title: string;
  alarms: readonly LiveAlarm[];
  acknowledgements: readonly Acknowledgement[];
  limits: Readonly<Record<string, readonly number[]>>;
  channels: readonly StreamChannel[];
}

/** Lane of alarms with their evidence, open until somebody acknowledges each by name. */
export function LiveAlarms({ streamId, title, alarms, acknowledgements, ...stream }: Props) {
  const describe = useEvidence(stream.limits, stream.channels);
  const name = useAnalyst();
  const acknowledge = useAcknowledgeAlarm(streamId);
  const { open, acknowledged } = splitAlarms(alarms, acknowledgements);
  useDocumentTitle(open.length > 0 ? `ALARM · ${title}` : `${title} · flexsid`);
  return (
    <div className="live-alarms" role="region" aria-label="Alarms" tabIndex={0}>
      {/* The region exists before it has alarms: only then are additions announced. */}
      <div role="alert" aria-live="assertive" data-testid="live-alarms">
        {open.map((alarm) => (
          <section key={alarmKey(alarm)} className="live-alarm">
            <span className="live-alarm-sign" aria-hidden="true">
              ⚠
            </span>
            <div>
              <h2 className="live-alarm-title">
                ALARM: {KINDS[alarm.kind]}, {alarm.subject}
              </h2>
              <p className="live-alarm-evidence numbers">
                {describe(alarm)}, at {fixed(alarm.time_s, 1)} s
              </p>
            </div>
            {name !== "" && (
              <Button
                size="md"
                variant="white"
                color="dark"
                loading={acknowledge.isPending}
                data-testid="acknowledge"
                onClick={() => {
                  acknowledge.mutate(alarm);
                }}
              >
                Acknowledge as {name}
              </Button>
            )}
          </section>
        ))}
      </div>
      {open.length > 0 && name === "" && (
        <div className="panel live-name">
          <Text size="sm">Set your name to acknowledge.</Text>
          <NameForm />
        </div>
      )}
      {acknowledge.isError && <ProblemAlert error={acknowledge.error} />}
      {open.length === 0 && <p className="quiet live-no-alarm">No open alarm</p>}
      {acknowledged.length > 0 && (
        <Stack gap={2} px="md" component="ul" className="lines" aria-label="Acknowledged alarms">
          {acknowledged.map((alarm) => (
            <li key={alarmKey(alarm)} data-testid="acknowledged">
              <span>
                ⚠ {KINDS[alarm.kind]}, {alarm.subject}: {describe(alarm)}
              </span>
              <span className="quiet">
                at {fixed(alarm.time_s, 1)} s, acknowledged by {alarm.author}
              </span>
            </li>
          ))}
        </Stack>
      )}
    </div>
  );
}

/** Describes the evidence of an alarm; that of limits in display units. */
function useEvidence(limits: Props["limits"], channels: Props["channels"]) {
  const convert = useConversion();
  return ({ kind, subject, evidence }: LiveAlarm) => {
    const channel = channels.find((one) => one.name === subject);
    const range = limits[subject];
    if (kind !== "limit" || channel === undefined || range === undefined) return evidence;
    const { name, factor } = convert(channel.unit);
    return `beyond ${range.map((limit) => significant(factor * limit, 3)).join(" to ")} ${name}`;
  };
}
