import { Group, Select } from "@mantine/core";
import type { Prediction } from "../../api/types";
import { LATTICE_QUANTITIES, type AircraftView } from "../../views";
import { Figure } from "../figures/Figure";
import { Section } from "../display/Section";

type Quantity = (typeof LATTICE_QUANTITIES)[number];

const LABELS: Record<Quantity, string> = {
  layout: "Surfaces and sensors",
  pressure: "Pressure",
  mode: "Mode on the boxes",
  "aspect-ratio": "Aspect ratio",
  resolution: "Boxes per wavelength",
};

interface Props {
  prediction: Prediction;
  view: AircraftView;
  onChange: (change: Partial<AircraftView>) => void;
}

/** Boxes of a computed prediction: layout, pressures, splined modes and quality. */
export function LatticeSection({ prediction, view, onChange }: Props) {
  const lattice = prediction.unsteady?.lattice;
  if (!lattice) return null;
  const quantity = view.quantity ?? "layout";
  const columns =
    quantity === "pressure"
      ? lattice.columns
      : quantity === "mode"
        ? lattice.modes.map(String)
        : [];
  const column =
    view.column !== undefined && columns.includes(view.column) ? view.column : columns[0];
  return (
    <Section title={`Lattice of ${prediction.source}`} note={prediction.note}>
      <Group mb="sm">
        <Select
          label="Quantity"
          allowDeselect={false}
          data-testid="lattice-quantity"
          data={LATTICE_QUANTITIES.map((value) => ({ value, label: LABELS[value] }))}
          value={quantity}
          onChange={(value) => {
            onChange({
              quantity: LATTICE_QUANTITIES.find((one) => one === value),
              column: undefined,
            });
          }}
        />
        {columns.length > 0 && (
          <Select
            label={quantity === "mode" ? "Mode" : "Variable"}
            allowDeselect={false}
            data-testid="lattice-column"
            data={columns}
            value={column ?? null}
            onChange={(value) => {
              onChange({ column: value ?? undefined });
            }}
          />
        )}
      </Group>
      <Figure
        kind="lattice"
        title={LABELS[quantity]}
        height={560}
        params={{ prediction_id: prediction.id, quantity, column }}
      />
    </Section>
  );
}
