import { Text } from "@mantine/core";
import type { DecisionEvent } from "../../api/types";
import { dateTime } from "../../lib/text/format";
import { DerivativeName } from "../display/DerivativeName";

const DONE: Record<DecisionEvent["kind"], string> = {
  proposed: "proposed this",
  revised: "revised the proposal",
  commented: "commented",
  voted: "voted",
  withdrawn: "withdrew the proposal",
  adopted: "adopted it as baseline with the last approval",
  declined: "ended it with the last rejection",
  superseded: "superseded it with a later baseline",
  narrowed: "narrowed its range with a later baseline",
};
const VOTED = {
  approve: "approved",
  "request-changes": "requested changes",
  reject: "rejected",
};

interface Props {
  events: DecisionEvent[];
  /** Restricts the thread to this derivative and the whole proposal. */
  derivative?: string;
}

/** Comments and events of a decision, oldest first, with their data hashes. */
export function DecisionThread({ events, derivative }: Props) {
  const shown = events.filter(
    (one) => derivative === undefined || one.derivative === null || one.derivative === derivative,
  );
  return (
    <ol className="thread" data-testid="thread">
      {shown.map((event) => (
        <li key={event.number} data-kind={event.kind} data-testid={`event-${event.number}`}>
          <Text size="sm">
            <b>{event.author}</b>{" "}
            {!event.author_verified && <span className="quiet">(unverified) </span>}
            {event.vote === null ? DONE[event.kind] : VOTED[event.vote]}
            {event.derivative !== null && (
              <>
                {" "}
                on <DerivativeName name={event.derivative} />
              </>
            )}
          </Text>
          <Text size="sm" style={{ whiteSpace: "pre-wrap", overflowWrap: "anywhere" }}>
            {event.text}
          </Text>
          <Text size="xs" className="quiet numbers">
            {dateTime(event.created_at)}, revision {event.revision},{" "}
            <span
              title={[
                `data ${event.data_hash}`,
                ...Object.entries(event.data).map(([name, hash]) => `${name}: ${hash}`),
              ].join("\n")}
            >
              data {event.data_hash.slice(0, 10)}
            </span>
            ,{" "}
            <span
              title={Object.entries(event.software)
                .map(([name, version]) => `${name} ${version}`)
                .join("\n")}
            >
              flexsid {event.software.flexsid}
            </span>
            , <span title={event.hash}>event {event.hash.slice(0, 10)}</span>
          </Text>
        </li>
      ))}
    </ol>
  );
}
