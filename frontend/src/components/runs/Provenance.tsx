import { Stack } from "@mantine/core";
import type { ReactNode } from "react";
import type { Run } from "../../api/types";
import { dateTime, elapsed } from "../../lib/text/format";
import { heldAt, heldText } from "../../lib/structure";
import { Facts } from "../display/ConditionFacts";
import { Band } from "../display/Quantity";
import { Section } from "../display/Section";
import { StructureLink } from "../structures/StructureLink";

/** Provenance of a result, sufficient to reproduce it. */
export function Provenance({ run }: { run: Run }) {
  const { structure, settings } = run;
  const listed = (names: readonly (string | number)[], none: string) =>
    names.length > 0 ? names.join(", ") : none;
  return (
    <Stack gap="md">
      <Section title="Model structure">
        <Facts
          facts={[
            ...(run.structure_id === null
              ? []
              : [
                  [
                    "Stored model structure",
                    <StructureLink
                      key="structure"
                      name={`Structure ${run.structure_id}`}
                      id={run.structure_id}
                      version={run.structure_version ?? 1}
                    />,
                  ] as [string, ReactNode],
                ]),
            ["Modes", listed(structure.modes, "rigid body only")],
            ["Inputs", listed(structure.inputs, "all of the maneuver")],
            ["Outputs", listed(structure.outputs, "all suitable")],
            ["Free derivatives", structure.free == null ? "all others" : structure.free.length],
            ["Absent", listed(structure.absent, "none")],
            ["Fixed", listed(fixedIn(structure), "none")],
            ["Time delays", structure.free_delays ? "estimated" : "held"],
          ]}
        />
      </Section>
      <Section title="Settings">
        <Facts
          facts={[
            ...(run.template === null
              ? []
              : [["Template", templateText(run.template)] as [string, ReactNode]]),
            ["Start", settings.start.replaceAll("-", " ")],
            [
              "Band",
              settings.band_hz == null ? "as excited" : <Band key="band" hz={settings.band_hz} />,
            ],
            ["Maximum iterations", settings.max_iterations],
            ["Noise", settings.noise],
            ["Modal table", run.modal_table_id ?? "default"],
            ["Damping table", run.damping_table_id ?? "none"],
            ["Prediction", run.prediction_id ?? "none"],
          ]}
        />
      </Section>
      <Section title="Times and versions">
        <Facts
          facts={[
            ["Requested", dateTime(run.created_at)],
            ["Started", dateTime(run.started_at)],
            ["Finished", dateTime(run.finished_at)],
            ["Duration", elapsed(run.started_at, run.finished_at)],
            ...(run.author ? [["Author", run.author] as [string, string]] : []),
            ...Object.entries(run.versions ?? {}).map(
              ([name, version]) => [name, version] as [string, string],
            ),
          ]}
        />
      </Section>
    </Stack>
  );
}

function templateText({ name, revision, changed_settings: changed }: NonNullable<Run["template"]>) {
  const text = `${name}, revision ${revision}`;
  return changed.length === 0 ? text : `${text}, changed: ${changed.join(", ")}`;
}

function fixedIn({ fixed, fixed_to }: Run["structure"]): string[] {
  return [...Object.keys(fixed), ...Object.keys(fixed_to)].map(
    (name) => `${name} to ${heldText(heldAt({ free: null, absent: [], fixed, fixed_to }, name))}`,
  );
}
