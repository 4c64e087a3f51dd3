import { Button, Group, Stack, Text, Textarea, TextInput } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { useComputePrediction } from "../../api/commands";
import { predictionsQuery } from "../../api/queries";
import type { Aircraft } from "../../api/types";
import type { PredictionAxis } from "../../views";
import { JobWait } from "../jobs/JobWait";
import { NumberField } from "../controls/NumberField";
import { PredictionAxisPicker } from "./PredictionAxisPicker";
import { ProblemAlert } from "../display/ProblemAlert";

const EXAMPLE = `CAERO1,1001,1,,10,8,,,1
,0.,0.,0.,1.,0.5,4.,0.,0.6`;

/** Form that computes a prediction from a planform, and the progress of its job. */
export function ComputePrediction({ aircraft }: { aircraft: Aircraft }) {
  const [editing, setEditing] = useState(false);
  const [source, setSource] = useState("Doublet lattice");
  const [axis, setAxis] = useState<PredictionAxis>("longitudinal");
  const [deck, setDeck] = useState("");
  const [unit, setUnit] = useState("m");
  const [surfaces, setSurfaces] = useState("");
  const [mach, setMach] = useState<number | null>(0);
  const [referenceK, setReferenceK] = useState<number | null>(0);
  const [wrong, setWrong] = useState("");
  const client = useQueryClient();
  const compute = useComputePrediction();
  const job = compute.data?.id;
  return (
    <Stack gap="sm" mb="md">
      <Group>
        <Button
          variant="default"
          size="xs"
          aria-expanded={editing}
          data-testid="compute-prediction"
          onClick={() => {
            setEditing(!editing);
          }}
        >
          Compute prediction
        </Button>
      </Group>
      {job !== undefined && (
        <JobWait
          key={job}
          id={job}
          onEnd={(ended) => {
            if (ended.state !== "succeeded") return;
            setEditing(false);
            void client.invalidateQueries({ queryKey: predictionsQuery(aircraft.id).queryKey });
          }}
        />
      )}
      {editing && (
        <form
          onSubmit={(event) => {
            event.preventDefault();
            const found = readSurfaces(surfaces);
            setWrong(typeof found === "string" ? found : "");
            if (typeof found === "string") return;
            compute.mutate({
              aircraft_id: aircraft.id,
              source,
              axis,
              panels: [],
              surfaces: found,
              deck,
              deck_unit: unit,
              modes: [],
              mach: mach ?? 0,
              reference_k: referenceK ?? 0,
              highest_k: 2,
            });
          }}
        >
          <Stack gap="sm" style={{ maxWidth: 640 }}>
            <Text size="sm" className="quiet">
              Derivatives of rigid motion, modes and surfaces by reduced frequency, from a doublet
              lattice on the right half. Mode shapes are those of the modal table. Thickness, drag
              and terms of the trim lift are not predicted.
            </Text>
            <PredictionAxisPicker
              description={
                axis === "lateral"
                  ? "Antisymmetric modes and surfaces; deflections positive with the right trailing edge down"
                  : "Symmetric modes and surfaces"
              }
              value={axis}
              onChange={setAxis}
            />
            <TextInput
              label="Name"
              required
              value={source}
              onChange={(event) => {
                setSource(event.currentTarget.value);
              }}
            />
            <Textarea
              label="Planform"
              description="CAERO1 entries of a Nastran deck, with the AEFACT lists they refer to. X aft, Y right, Z up."
              required
              autosize
              minRows={5}
              maxRows={16}
              placeholder={EXAMPLE}
              styles={{ input: { fontFamily: "monospace" } }}
              data-testid="planform-deck"
              value={deck}
              onChange={(event) => {
                setDeck(event.currentTarget.value);
              }}
            />
            <Textarea
              label="Surfaces"
              description="One in a line: name, Y of the inboard and the outboard end in m, hinge as fraction of the chord."
              autosize
              minRows={2}
              maxRows={12}
              placeholder={axis === "lateral" ? "wf1a, 0.9, 1.7, 0.75" : "wf1s, 0.9, 1.7, 0.75"}
              error={wrong || undefined}
              styles={{ input: { fontFamily: "monospace" } }}
              value={surfaces}
              onChange={(event) => {
                setSurfaces(event.currentTarget.value);
              }}
            />
            <Group grow align="end">
              <TextInput
                label="Unit of the deck"
                value={unit}
                onChange={(event) => {
                  setUnit(event.currentTarget.value);
                }}
              />
              <NumberField
                label="Mach number"
                min={0}
                max={0.89}
                step={0.05}
                value={mach}
                onChange={(value) => {
                  setMach(value ?? null);
                }}
              />
              <NumberField
                label="Reference k"
                description="Of the mode that flutters, or 0"
                min={0}
                max={2}
                step={0.05}
                value={referenceK}
                onChange={(value) => {
                  setReferenceK(value ?? null);
                }}
              />
            </Group>
            {compute.isError && <ProblemAlert error={compute.error} />}
            <Group>
              <Button type="submit" size="sm" loading={compute.isPending}>
                Compute
              </Button>
            </Group>
          </Stack>
        </form>
      )}
    </Stack>
  );
}

interface PlanformSurface {
  name: string;
  span: [number, number];
  hinge: number;
}

/** Surfaces of a text, or the reason why it cannot be read. */
function readSurfaces(text: string): PlanformSurface[] | string {
  const found: PlanformSurface[] = [];
  for (const line of text.split("\n")) {
    if (line.trim() === "") continue;
    const [name = "", ...rest] = line.split(",").map((part) => part.trim());
    const [inboard, outboard, hinge = 0.75] = rest.map(Number);
    const numbers = [inboard, outboard, hinge];
    if (
      inboard === undefined ||
      outboard === undefined ||
      !numbers.every((one) => Number.isFinite(one))
    ) {
      return `"${line}" is not a name, two numbers and a hinge`;
    }
    found.push({ name, span: [inboard, outboard], hinge });
  }
  return found;
}
