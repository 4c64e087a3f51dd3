import { Button, Group, Select, Stack, Text, Textarea, TextInput } from "@mantine/core";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { useState } from "react";
import { useStartStream } from "../../api/commands";
import { flightsQuery, maneuverQuery, receiversQuery, runListQuery } from "../../api/queries";
import type { Receiver, RunItem } from "../../api/types";
import { flightName } from "../../lib/text/format";
import { parseTable } from "../../lib/live/table";
import { integer } from "../../lib/urlState";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";
import { StreamLimits, type ChannelLimit } from "./StreamLimits";

const MOST_RUNS = 100;

/** Form of a stream: the run whose settings it has, where samples come from, and limits. */
export function StartStream({ run }: { run?: number }) {
  const receivers = useQuery(receiversQuery);
  const runs = useInfiniteQuery(runListQuery({ state: "succeeded" }, "-id", MOST_RUNS));
  return (
    <Loaded query={receivers} rows={6}>
      {(known) => (
        <Loaded query={runs} rows={6}>
          {({ pages }) => {
            const items = pages[0]?.items ?? [];
            return items.length === 0 ? (
              <Empty title="No succeeded runs yet">
                A stream has model, channels and settings of a run.{" "}
                <Link to="/campaign" className="link">
                  Estimate a maneuver
                </Link>{" "}
                first.
              </Empty>
            ) : (
              <Form receivers={known} runs={items} first={run} />
            );
          }}
        </Loaded>
      )}
    </Loaded>
  );
}

interface FormProps {
  receivers: Receiver[];
  runs: RunItem[];
  first: number | undefined;
}

function Form({ receivers, runs, first }: FormProps) {
  const navigate = useNavigate();
  const start = useStartStream();
  const flights = useQuery(flightsQuery);
  const [runId, setRunId] = useState(
    () => (runs.find((one) => one.id === first) ?? runs[0])?.id ?? 0,
  );
  const [name, setName] = useState(receivers[0]?.name ?? "");
  const [options, setOptions] = useState<Record<string, string | number>>({});
  const [title, setTitle] = useState("");
  const [flightId, setFlightId] = useState<string | null>(null);
  const [next, setNext] = useState<number>();
  const [limits, setLimits] = useState<ChannelLimit[]>([]);
  const run = runs.find((one) => one.id === runId);
  const receiver = receivers.find((one) => one.name === name);
  const maneuver = useQuery({
    ...maneuverQuery(run?.maneuver_id ?? 0),
    enabled: run !== undefined,
  });
  const proposedTitle =
    name === "replay" ? `Replay of ${run?.maneuver_label ?? ""}` : (receiver?.label ?? "");
  // A replay is of the maneuver of the run unless another one is given.
  const valueOf = (option: Receiver["options"][number]) =>
    options[option.name] ??
    (option.name === "maneuver_id" ? run?.maneuver_id : (option.default as string | number)) ??
    "";
  const own = (flights.data ?? []).filter((flight) => flight.aircraft_id === run?.aircraft_id);
  return (
    <Stack
      gap="xs"
      component="form"
      aria-label="Start a stream"
      onSubmit={(event) => {
        event.preventDefault();
        start.mutate(
          {
            run_id: runId,
            title: title.trim() || proposedTitle,
            receiver: {
              name,
              options: Object.fromEntries(
                (receiver?.options ?? [])
                  .filter((option) => valueOf(option) !== "")
                  .map((option) => {
                    const value = valueOf(option);
                    return [option.name, option.type === "object" ? parseTable(value) : value];
                  }),
              ),
            },
            flight_id: integer(flightId) ?? null,
            next_airspeed_m_s: next ?? null,
            limits: Object.fromEntries(
              limits.flatMap(({ channel, low, high }) =>
                low === undefined || high === undefined
                  ? []
                  : [[channel, [low, high] as [number, number]]],
              ),
            ),
          },
          {
            onSuccess: (stream) => void navigate({ to: "/live/$id", params: { id: stream.id } }),
          },
        );
      }}
    >
      <Select
        label="Model, channels and settings of"
        searchable
        allowDeselect={false}
        data={runs.map((one) => ({
          value: String(one.id),
          label: `${one.method} run ${one.id}, ${one.maneuver_label}`,
        }))}
        value={String(runId)}
        onChange={(value) => {
          setRunId(integer(value) ?? runId);
        }}
        data-testid="stream-run"
      />
      <Select
        label="Receiver"
        allowDeselect={false}
        data={receivers.map(({ name, label, missing_extra: extra }) => ({
          value: name,
          label: extra === null ? label : `${label} (needs flexsid[${extra}] on the server)`,
          disabled: extra !== null,
        }))}
        value={name}
        onChange={(value) => {
          setName(value ?? name);
          setOptions({});
        }}
        data-testid="stream-receiver"
      />
      {receiver?.options.map((option) => {
        const label = labelOf(option.name);
        const set = (value: string | number) => {
          setOptions({ ...options, [option.name]: value });
        };
        return option.type === "integer" || option.type === "number" ? (
          <NumberField
            key={option.name}
            label={label}
            description={option.description}
            required={option.is_required}
            allowDecimal={option.type === "number"}
            min={0}
            value={numberOf(valueOf(option))}
            onChange={(value) => {
              set(value ?? "");
            }}
            data-testid={`option-${option.name}`}
          />
        ) : option.type === "object" ? (
          <Textarea
            key={option.name}
            label={label}
            description={`${option.description} One in each row.`}
            required={option.is_required}
            autosize
            minRows={3}
            maxRows={12}
            value={String(valueOf(option))}
            onChange={(event) => {
              set(event.currentTarget.value);
            }}
            data-testid={`option-${option.name}`}
          />
        ) : (
          <TextInput
            key={option.name}
            label={label}
            description={option.description}
            required={option.is_required}
            value={String(valueOf(option))}
            onChange={(event) => {
              set(event.currentTarget.value);
            }}
            data-testid={`option-${option.name}`}
          />
        );
      })}
      <TextInput
        label="Title"
        placeholder={proposedTitle}
        maxLength={200}
        value={title}
        onChange={(event) => {
          setTitle(event.currentTarget.value);
        }}
      />
      <Group gap="xs" grow align="end">
        <NumberField
          label="Next test point"
          unit="m/s"
          placeholder="none"
          isPositive
          value={next}
          onChange={setNext}
          data-testid="stream-next"
        />
        <Select
          label="Store maneuvers in"
          placeholder="not stored"
          clearable
          data={own.map((flight) => ({
            value: String(flight.id),
            label: flightName(flight.number),
          }))}
          value={flightId}
          onChange={setFlightId}
          data-testid="stream-flight"
        />
      </Group>
      <StreamLimits channels={maneuver.data?.channels ?? []} limits={limits} onChange={setLimits} />
      <Text size="xs" className="quiet">
        The result advises; whether the next test point is flown is decided in the control room.
      </Text>
      <Button type="submit" loading={start.isPending} data-testid="start-stream">
        Start stream
      </Button>
      {start.isError && <ProblemAlert error={start.error} />}
    </Stack>
  );
}

const numberOf = (value: string | number) => (value === "" ? undefined : Number(value));

/** `maneuver_id` as `Maneuver id`. */
const labelOf = (name: string) => {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
};
