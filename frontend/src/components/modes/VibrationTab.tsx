import {
  Button,
  Checkbox,
  Group,
  MultiSelect,
  Select,
  Stack,
  Text,
  TextInput,
} from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useSaveFoundModes } from "../../api/commands";
import { measuredResponsesQuery } from "../../api/queries";
import { storedResult } from "../../api/storedResult";
import type { FoundModes, MeasuredResponses, ModalTable } from "../../api/types";
import { fixed, percent, significant } from "../../lib/text/format";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";
import { Quantity, UnitName } from "../display/Quantity";
import { Section } from "../display/Section";
import { hasShapes, tableTitle, type TabProps } from "./tables";

/** Measured responses of a ground vibration test: stabilisation diagram and identified modes. */
export function VibrationTab({ aircraft, usable, view, onChange }: TabProps) {
  const sets = useQuery(measuredResponsesQuery(aircraft.id));
  return (
    <Loaded query={sets} rows={6}>
      {(known) => {
        const responses = known.find((one) => one.id === view.responses) ?? known.at(-1);
        return responses === undefined ? (
          <Empty title="No measured responses yet">
            Import frequency responses, or forces and responses over time, with the coordinates of
            the nodes.
          </Empty>
        ) : (
          <OneSet {...{ known, responses, usable, view, onChange }} />
        );
      }}
    </Loaded>
  );
}

interface OneProps extends Pick<TabProps, "usable" | "view" | "onChange"> {
  known: MeasuredResponses[];
  responses: MeasuredResponses;
}

function OneSet({ known, responses, usable, view, onChange }: OneProps) {
  const band = { low_hz: view.from_hz, high_hz: view.to_hz, order: view.order ?? 40 };
  const poles = view.poles ?? [];
  const query = poles.length > 0 ? { ...band, poles: poles.join(",") } : band;
  return (
    <div className="split split-early">
      <Stack gap="md">
        <Select
          label="Measured responses"
          allowDeselect={false}
          data={known.map((one) => ({ value: String(one.id), label: one.name }))}
          value={String(responses.id)}
          onChange={(value) => {
            onChange({
              responses: Number(value),
              from_hz: undefined,
              to_hz: undefined,
              poles: undefined,
              response_dof: undefined,
              reference_dof: undefined,
            });
          }}
        />
        <NumberField
          label="From"
          unit="Hz"
          isPositive
          value={view.from_hz}
          onChange={(value) => {
            onChange({ from_hz: value, poles: undefined });
          }}
        />
        <NumberField
          label="To"
          unit="Hz"
          isPositive
          value={view.to_hz}
          onChange={(value) => {
            onChange({ to_hz: value, poles: undefined });
          }}
        />
        <NumberField
          label="Highest model order"
          min={4}
          max={80}
          allowDecimal={false}
          value={view.order ?? 40}
          onChange={(value) => {
            onChange({ order: value, poles: undefined });
          }}
        />
        <Text size="xs" className="quiet">
          {responses.outputs.length} points, {responses.references.length} shakers,{" "}
          {responses.quantity} per force, {percent(responses.fuel)} % fuel.{" "}
          {responses.notes.join(" ")}
        </Text>
      </Stack>
      <Stack gap="md">
        {/* By its key requested at once: the analyst asks for the fit of poles by a button. */}
        <ComputedResult
          key={poles.join(",")}
          options={storedResult("/api/v1/measured-responses/{responses_id}/modes", {
            path: { responses_id: responses.id },
            query,
          })}
          rows={6}
        >
          {(found) => (
            <>
              <Diagram
                key={`diagram ${String(responses.id)} ${JSON.stringify(query)}`}
                {...{ found, query, onChange }}
              />
              <Found
                key={`${String(responses.id)} ${JSON.stringify(query)}`}
                {...{ found, query: band, poles, usable, onChange }}
              />
            </>
          )}
        </ComputedResult>
        <OneResponse {...{ responses, view, onChange }} />
      </Stack>
    </div>
  );
}

interface DiagramProps extends Pick<TabProps, "onChange"> {
  found: FoundModes;
  query: Record<string, string | number | undefined>;
}

/** Stabilisation diagram; poles are selected by a click or in the list, then fitted. */
function Diagram({ found, query, onChange }: DiagramProps) {
  const [picked, setPicked] = useState(found.selected.map((pole) => String(pole.number)));
  const stable = new Set(found.poles.map((pole) => String(pole.number)));
  return (
    <div className="panel" style={{ padding: 12 }}>
      <Figure
        kind="stabilisation"
        title="Stabilisation diagram over the mean response"
        params={{ responses_id: found.responses_id, ...query }}
        height={560}
        onPick={(number) => {
          const pole = String(number);
          if (!stable.has(pole)) return;
          setPicked((before) =>
            before.includes(pole) ? before.filter((one) => one !== pole) : [...before, pole],
          );
        }}
      />
      <Group align="end">
        <MultiSelect
          label="Poles selected by hand"
          description="Click stable poles in the diagram, or search by frequency"
          searchable
          limit={50}
          style={{ flex: 1, minWidth: 300 }}
          data={found.poles.map((pole) => ({
            value: String(pole.number),
            label: `${fixed(pole.frequency_hz, 3)} Hz, ${percent(pole.damping, 2)} %, order ${String(pole.order)}`,
          }))}
          value={picked}
          onChange={setPicked}
        />
        <Button
          variant="default"
          disabled={picked.length === 0}
          onClick={() => {
            onChange({ poles: picked.map(Number) });
          }}
        >
          Fit selected poles
        </Button>
        {found.selected.length > 0 && (
          <Button
            variant="default"
            onClick={() => {
              onChange({ poles: undefined });
            }}
          >
            Select automatically
          </Button>
        )}
      </Group>
    </div>
  );
}

/** One frequency response, with coherence and standard deviation if it was estimated here. */
function OneResponse({ responses, view, onChange }: Omit<OneProps, "known" | "usable">) {
  const output = responses.outputs.find((one) => one === view.response_dof) ?? responses.outputs[0];
  const reference =
    responses.references.find((one) => one === view.reference_dof) ?? responses.references[0];
  return (
    <Section title="Measured response">
      <Stack gap="md">
        <Group>
          <Select
            label="Response"
            searchable
            allowDeselect={false}
            data={responses.outputs}
            value={output ?? null}
            onChange={(value) => {
              onChange({ response_dof: value ?? undefined });
            }}
          />
          <Select
            label="Force"
            allowDeselect={false}
            data={responses.references}
            value={reference ?? null}
            onChange={(value) => {
              onChange({ reference_dof: value ?? undefined });
            }}
          />
        </Group>
        {output !== undefined && reference !== undefined && (
          <Figure
            kind="measured-response"
            title={`Response of ${output} to a force at ${reference}`}
            params={{ responses_id: responses.id, response_dof: output, reference_dof: reference }}
            height={520}
          />
        )}
      </Stack>
    </Section>
  );
}

interface FoundProps extends Pick<TabProps, "onChange"> {
  found: FoundModes;
  query: { low_hz?: number; high_hz?: number; order: number };
  poles: number[];
  usable: ModalTable[];
}

function Found({ found, query, poles, usable, onChange }: FoundProps) {
  const save = useSaveFoundModes(found.responses_id);
  const templates = usable.filter((table) => hasShapes(table) && table.kind === "FEM");
  const [left, setLeft] = useState<number[]>([]);
  const [name, setName] = useState("GVT");
  const [template, setTemplate] = useState<number | null>(templates.at(-1)?.id ?? null);
  const rows = found.items.map((mode, index) => ({ ...mode, index }));
  const selected = rows.map((row) => row.index).filter((index) => !left.includes(index));
  return (
    <Section
      title="Identified modes"
      note={`± is 2σ by the covariance of the fit. Fit error of the synthesised responses: ${percent(found.fit_error, 1)} %.`}
    >
      <Stack gap="md">
        {found.unmodelled_hz.length > 0 && (
          <Text size="sm" data-testid="unmodelled-modes">
            The residuals resemble a mode that is not identified at{" "}
            {found.unmodelled_hz.map((hertz) => fixed(hertz, 2)).join(", ")} Hz; check the responses
            there, or take a narrower band.
          </Text>
        )}
        {found.unresolved_hz.length > 0 && (
          <Text size="sm" data-testid="unresolved-modes">
            Damping is too high by leakage at{" "}
            {found.unresolved_hz.map((hertz) => fixed(hertz, 2)).join(", ")} Hz: the half-power
            bandwidth is less than four resolution bandwidths of the spectra. Estimate the responses
            with fewer averages, or record for longer.
          </Text>
        )}
        <DataTable
          label="Identified modes"
          testId="found-modes"
          columns={[
            {
              key: "save",
              header: "Save",
              render: (row) => (
                <Checkbox
                  aria-label={`Save the mode at ${fixed(row.frequency_hz, 2)} Hz`}
                  checked={!left.includes(row.index)}
                  onChange={(event) => {
                    const on = event.currentTarget.checked;
                    setLeft((before) =>
                      on ? before.filter((one) => one !== row.index) : [...before, row.index],
                    );
                  }}
                />
              ),
            },
            {
              key: "hz",
              header: "Frequency",
              unit: <UnitName unit="Hz" />,
              numeric: true,
              render: (row) => (
                <>
                  <Quantity value={row.frequency_hz} unit="Hz" decimals={3} /> ±{" "}
                  <Quantity value={2 * row.std_hz} unit="Hz" decimals={4} />
                </>
              ),
            },
            {
              key: "damping",
              header: "Damping",
              unit: "%",
              numeric: true,
              render: (row) =>
                `${percent(row.damping, 2)} ± ${significant(200 * row.std_damping, 2)}`,
            },
            { key: "orders", header: "Orders", numeric: true, render: (row) => row.n_orders },
            {
              key: "real",
              header: "Phase collinearity",
              help: "Phase collinearity",
              numeric: true,
              render: (row) => fixed(row.collinearity, 3),
            },
          ]}
          rows={rows}
          rowKey={(row) => row.index}
        />
        <Group align="end">
          <TextInput
            label="Save as"
            value={name}
            onChange={(event) => {
              setName(event.currentTarget.value);
            }}
          />
          <Select
            label="Names and numbers from"
            clearable
            data={templates.map((table) => ({ value: String(table.id), label: tableTitle(table) }))}
            value={template === null ? null : String(template)}
            onChange={(value) => {
              setTemplate(value === null ? null : Number(value));
            }}
          />
          <Button
            loading={save.isPending}
            disabled={selected.length === 0 || name.trim() === ""}
            onClick={() => {
              save.mutate(
                { name: name.trim(), ...query, poles, selected, template_id: template },
                {
                  onSuccess: (table) => {
                    onChange({
                      tab: "mac",
                      table: template ?? table.id,
                      other: table.id,
                      fuel: 100 * (table.fuel[0] ?? 0),
                      other_fuel: undefined,
                    });
                  },
                },
              );
            }}
          >
            Save {selected.length} modes
          </Button>
        </Group>
        {save.isError && <ProblemAlert error={save.error} />}
      </Stack>
    </Section>
  );
}
