import { Button, Group, Select, Slider, Stack, Switch, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { address } from "../../api/client";
import { modesAtQuery, shapeQuery } from "../../api/queries";
import type { ModalTable } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { CAMERA, type Camera } from "../../lib/figures/projection";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { ShapeCanvas } from "../figures/ShapeCanvas";
import { hasShapes, tableTitle, type TableProps } from "./tables";

/** Mode shapes in three dimensions: one, or two modes or sources side by side. */
export function ShapesTab({ table, usable, view, onChange }: TableProps) {
  const [camera, setCamera] = useState<Camera>(CAMERA);
  const fuel = (view.fuel ?? 50) / 100;
  const drawable = usable.filter(hasShapes);
  const scale = (view.scale ?? 10) / 100;
  const shared = { fuel, scale, playing: view.still !== true, camera, onCamera: setCamera };
  const other = drawable.find((one) => one.id === view.other) ?? table;
  if (!hasShapes(table))
    return (
      <Empty title="No shapes at nodes">
        {tableTitle(table)} contains frequencies only. Select a table with shapes.
      </Empty>
    );
  return (
    <Stack gap="md">
      <Group gap="lg" align="end">
        <Switch
          label="Side by side"
          checked={view.side_by_side === true}
          onChange={(event) => {
            onChange({ side_by_side: event.currentTarget.checked || undefined });
          }}
        />
        <Switch
          label="Animate"
          checked={view.still !== true}
          onChange={(event) => {
            onChange({ still: event.currentTarget.checked ? undefined : true });
          }}
        />
        <div style={{ width: 220 }}>
          <Text size="sm" fw={500}>
            Largest displacement: {view.scale ?? 10} % of the span
          </Text>
          <Slider
            thumbLabel="Largest displacement in percent of the span"
            min={1}
            max={40}
            label={null}
            defaultValue={view.scale ?? 10}
            onChangeEnd={(value) => {
              onChange({ scale: value });
            }}
          />
        </div>
        <Button
          variant="default"
          onClick={() => {
            setCamera(CAMERA);
          }}
        >
          Reset view
        </Button>
      </Group>
      <div className={view.side_by_side === true ? "halves" : undefined}>
        <OneShape
          {...shared}
          table={table}
          number={view.mode}
          onNumber={(mode) => {
            onChange({ mode });
          }}
        />
        {view.side_by_side === true && (
          <OneShape
            {...shared}
            table={other}
            tables={drawable}
            onTable={(id) => {
              onChange({ other: id, other_mode: undefined });
            }}
            number={view.other_mode}
            second={other.id === table.id}
            onNumber={(mode) => {
              onChange({ other_mode: mode });
            }}
          />
        )}
      </div>
      <Text size="xs" className="quiet">
        Undeformed faint, deformed strong; sensors are dots; hover for φ and ν (per unit η, body
        axes). Drag or arrow keys rotate, wheel or + and − zoom.
      </Text>
    </Stack>
  );
}

interface OneProps {
  table: ModalTable;
  tables?: ModalTable[];
  onTable?: (id: number) => void;
  number: number | undefined;
  /** Begins with the second mode rather than the first. */
  second?: boolean;
  onNumber: (number: number) => void;
  fuel: number;
  scale: number;
  playing: boolean;
  camera: Camera;
  onCamera: (camera: Camera) => void;
}

function OneShape(props: OneProps) {
  const { table, tables, fuel } = props;
  const modes = useQuery(modesAtQuery(table.id, fuel));
  const items = modes.data?.items ?? [];
  const number = props.number ?? items[props.second === true ? 1 : 0]?.number;
  return (
    <div className="panel" style={{ padding: 12 }}>
      <Group gap="sm" mb="xs">
        {tables !== undefined && (
          <Select
            aria-label="Second modal table"
            size="xs"
            allowDeselect={false}
            data={tables.map((one) => ({ value: String(one.id), label: tableTitle(one) }))}
            value={String(table.id)}
            onChange={(value) => props.onTable?.(Number(value))}
          />
        )}
        <Select
          aria-label="Mode"
          data-testid="mode"
          size="xs"
          w={240}
          searchable
          allowDeselect={false}
          data={items.map((mode) => ({
            value: String(mode.number),
            label: `${String(mode.number)}: ${mode.name}, ${fixed(mode.frequency_hz, 2)} Hz`,
          }))}
          value={number === undefined ? null : String(number)}
          onChange={(value) => {
            props.onNumber(Number(value));
          }}
        />
      </Group>
      {number !== undefined && <Drawn {...props} number={number} />}
    </div>
  );
}

function Drawn({ table, number, fuel, ...view }: OneProps & { number: number }) {
  const shape = useQuery(shapeQuery(table.id, number, fuel));
  return (
    <Loaded query={shape} rows={12}>
      {(data) => (
        <>
          <ShapeCanvas
            shape={data}
            scale={view.scale}
            playing={view.playing}
            camera={view.camera}
            onCamera={view.onCamera}
          />
          <Group gap="xs">
            <Text size="xs" className="quiet">
              {data.name}, {fixed(data.frequency_hz, 3)} Hz; {data.nodes_m.length} of {data.n_nodes}{" "}
              nodes
              {data.quadrature_m !== null &&
                `; complex, phase collinearity ${fixed(data.collinearity, 3)}`}
            </Text>
            {[false, true].map((moving) => (
              <Button
                key={String(moving)}
                size="compact-xs"
                variant="default"
                className="no-print"
                component="a"
                href={address(`modal-tables/${String(table.id)}/picture`, {
                  number,
                  fuel,
                  moving,
                  scale: view.scale,
                  azimuth: view.camera.azimuth % (2 * Math.PI),
                  elevation: view.camera.elevation,
                })}
              >
                {moving ? "Animation (SVG)" : "Picture (SVG)"}
              </Button>
            ))}
          </Group>
        </>
      )}
    </Loaded>
  );
}
