import { Alert, Button, Group, List, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { qualityQuery } from "../../api/queries";
import type { ManeuverQuality } from "../../api/types";
import { useEffect, useEffectEvent } from "react";
import { useAssessManeuver, useTakeCorrections } from "../../api/commands";
import { calibrationsOf, delaysOf, repairsOf } from "./corrections";
import { count, fixed, percent, significant } from "../../lib/text/format";
import { overFrequency } from "../../lib/figures/band";
import { BandBar } from "../maneuvers/BandBar";
import { ConditioningSteps } from "./ConditioningSteps";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Facts } from "../display/ConditionFacts";
import { Figure } from "../figures/Figure";
import { JobWait } from "../jobs/JobWait";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { QualityChannels } from "./QualityChannels";
import { QualitySurfaces } from "./QualitySurfaces";
import { Section } from "../display/Section";
import type { ManeuverTabProps } from "../maneuvers/TimeHistoryTab";
import { VERDICT_COLORS } from "../display/VerdictBadge";

const AVERAGES: Column<ManeuverQuality["report"]["condition"]["averages"][number]>[] = [
  { key: "name", header: "Channel", render: (one) => one.name },
  numeric("mean", "Mean", (one) => significant(one.mean)),
  numeric("spread", "Spread", (one) => significant(one.std)),
  numeric("smallest", "Smallest", (one) => significant(one.smallest)),
  numeric("largest", "Largest", (one) => significant(one.largest)),
  numeric("drift", "Drift", (one) => significant(one.drift)),
  { key: "unit", header: "Unit", render: (one) => one.unit },
];

const TITLES = {
  good: "Good",
  questionable: "Questionable: check first",
  bad: "Bad: do not use for estimation",
  unchecked: "Cannot be checked",
} as const;

/** Quality of the recording: verdict, warnings, channels, condition, corrections. */
export function QualityTab({ maneuver, view, onChange }: ManeuverTabProps) {
  const quality = useQuery(qualityQuery(maneuver.id));
  const assess = useAssessManeuver(maneuver.id);
  const job = quality.data?.job;
  // A job that has ended was of earlier data.
  const isMissing = quality.data?.quality === null && (!job || job.state === "succeeded");
  const request = useEffectEvent(() => {
    assess.mutate();
  });
  useEffect(() => {
    if (isMissing) request();
  }, [isMissing]);
  return (
    <Loaded query={quality} rows={10}>
      {({ quality: found }) =>
        found !== null ? (
          <Found id={maneuver.id} quality={found} view={view} onChange={onChange} />
        ) : job ? (
          <JobWait key={job.id} id={job.id} onEnd={() => void quality.refetch()} />
        ) : (
          assess.isError && <ProblemAlert error={assess.error} />
        )
      }
    </Loaded>
  );
}

interface FoundProps extends Pick<ManeuverTabProps, "view" | "onChange"> {
  id: number;
  quality: ManeuverQuality;
}

function Found({ id, quality, view, onChange }: FoundProps) {
  const { report } = quality;
  const warnings = report.warnings.filter((one) => one.severity !== "good");
  const notes = report.warnings.filter((one) => one.severity === "good");
  const shared = overFrequency(view, onChange);
  return (
    <Stack gap="md">
      <Alert
        color={VERDICT_COLORS[quality.verdict]}
        variant="light"
        title={TITLES[quality.verdict]}
        role="status"
        data-testid={`quality-${quality.verdict}`}
      >
        {warnings.length === 0 ? (
          <Text size="sm">{quality.summary}</Text>
        ) : (
          <List size="sm" spacing={2}>
            {quality.verdict === "unchecked" && <List.Item>{quality.summary}</List.Item>}
            {warnings.map((warning, index) => (
              <List.Item key={index} fw={warning.severity === "bad" ? 600 : undefined}>
                {warning.text}
              </List.Item>
            ))}
          </List>
        )}
      </Alert>
      {notes.length > 0 && (
        <Text size="sm" className="quiet" data-testid="quality-notes">
          Noted, without effect on the verdict: {notes.map((one) => one.text).join(" ")}
        </Text>
      )}
      <Corrections id={id} quality={quality} />
      <Section title="Channels" note={<SkewNote quality={quality} />}>
        <QualityChannels channels={report.channels} />
      </Section>
      {report.surfaces.length > 0 && (
        <Section
          title="Surfaces"
          note="As flown against the recorded commands: servo, motion without command, limits"
        >
          <QualitySurfaces surfaces={report.surfaces} />
          <Figure
            kind="surface-histories"
            title="Surfaces against their commands"
            params={{ maneuver_id: id, start_s: view.from, stop_s: view.to, points: 2000 }}
            revision={[view.from, view.to].join()}
            onWindow={(window) => {
              onChange({ from: window?.[0], to: window?.[1] });
            }}
          />
        </Section>
      )}
      <Section
        title="Flight condition"
        note="Averages over the maneuver with their spread; drift is the trend from start to end"
      >
        <Condition quality={quality} />
      </Section>
      <div className="panel" style={{ padding: 12 }}>
        <BandBar
          maneuverId={id}
          window={shared.window}
          onClear={() => {
            shared.onWindow(null);
          }}
        />
        <Figure
          {...shared}
          kind="signal-to-noise"
          title="Signal-to-noise ratio by channel and frequency"
          params={{ maneuver_id: id }}
          height={140 + 15 * report.channels.filter(isHeard).length}
        />
      </div>
      {report.not_checked.length > 0 && (
        <Section title="Not checked">
          <List size="sm">
            {report.not_checked.map((reason) => (
              <List.Item key={reason}>{reason}</List.Item>
            ))}
          </List>
        </Section>
      )}
    </Stack>
  );
}

const isHeard = (channel: { role: string }) =>
  channel.role === "input" || channel.role === "output";

function bandOf(quality: ManeuverQuality): string {
  const band = quality.report.skew_band_hz;
  return band === null ? "" : `${fixed(band[0], 2)} to ${fixed(band[1], 2)} Hz`;
}

function SkewNote({ quality }: { quality: ManeuverQuality }) {
  const { skew_reference: reference } = quality.report;
  if (reference === null) return "Not checked against each other";
  return `Skews against ${reference}, from ${bandOf(quality)}; ± are standard errors`;
}

/** Corrections available from the warnings, and the corrections made. */
function Corrections({ id, quality }: { id: number; quality: ManeuverQuality }) {
  const take = useTakeCorrections(id);
  const channels = quality.report.channels;
  const offers = [
    { label: "Correct delays", what: "delay", items: delaysOf(channels, bandOf(quality)) },
    { label: "Calibrate", what: "calibration", items: calibrationsOf(channels) },
    { label: "Remove spikes", what: "repair", items: repairsOf(channels) },
  ].filter((offer) => offer.items.length > 0);
  return (
    <Section
      title="Corrections"
      note="Recorded data are not changed; each correction is a separate step and can be undone"
      actions={
        <Group gap="xs">
          {offers.map((offer) => (
            <Button
              key={offer.what}
              variant="default"
              loading={take.isPending}
              data-testid={`take-${offer.what}`}
              onClick={() => {
                take.mutate(offer.items);
              }}
            >
              {offer.label} ({count(offer.items.length, "channel")})
            </Button>
          ))}
        </Group>
      }
    >
      {take.isError && <ProblemAlert error={take.error} />}
      <ConditioningSteps id={id} />
    </Section>
  );
}

function Condition({ quality }: { quality: ManeuverQuality }) {
  const { condition } = quality.report;
  const lasting =
    condition.time_invariant === null ? "unknown" : condition.time_invariant ? "holds" : "does not";
  return (
    <Stack gap="sm">
      <Facts
        facts={[
          [
            <>
              V/V<sub>f</sub>
            </>,
            fixed(condition.airspeed_ratio, 3),
          ],
          ["Fuel", percent(condition.fuel_fraction), "%"],
          ["Fuel burnt meanwhile", percent(condition.fuel_change, 2), "%"],
          ["Airspeed drift", percent(condition.airspeed_drift, 2), "%"],
          ["Separation factor", fixed(condition.separation_factor, 2)],
          ["One linear model", lasting],
        ]}
      />
      {condition.averages.length > 0 && (
        <DataTable
          label="Averages"
          columns={AVERAGES}
          rows={condition.averages}
          rowKey={(one) => one.name}
        />
      )}
    </Stack>
  );
}
