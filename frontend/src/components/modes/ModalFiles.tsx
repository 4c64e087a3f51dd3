import { Button, Group, Select, Stack, Switch, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useRef, useState } from "react";
import {
  useImportFlutterSummary,
  useImportMassProperties,
  useImportStructure,
  useUploadFiles,
} from "../../api/commands";
import { structureUploadQuery } from "../../api/queries";
import type { Aircraft, StructureFound } from "../../api/types";
import { fixed, percent } from "../../lib/text/format";
import type { ModalDataView } from "../../views";
import { DataTable } from "../controls/DataTable";
import { Loaded } from "../display/Loaded";
import { NumberField } from "../controls/NumberField";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";
import { OrthogonalityForm, OrthogonalityResult } from "./OrthogonalityForm";
import { ResponsesForm } from "./ResponsesForm";

interface Props {
  aircraft: Aircraft;
  view: ModalDataView;
  onChange: (change: Partial<ModalDataView>) => void;
}

/** Import of modal data files: upload, contents, missing units, saving as a version. */
export function ModalFiles({ aircraft, view, onChange }: Props) {
  return (
    <Stack gap="md">
      <Choose onChange={onChange} />
      {view.upload !== undefined && (
        <Found
          key={view.upload}
          id={view.upload}
          aircraft={aircraft}
          fuel={(view.fuel ?? 50) / 100}
          onChange={onChange}
        />
      )}
      {view.orthogonality !== undefined && <OrthogonalityResult jobId={view.orthogonality} />}
    </Stack>
  );
}

function Choose({ onChange }: Pick<Props, "onChange">) {
  const send = useUploadFiles();
  const chooser = useRef<HTMLInputElement>(null);
  const take = (files: File[]) => {
    if (files.length === 0) return;
    send.mutate(files, {
      onSuccess: ({ upload }) => {
        onChange({ upload: upload.id });
      },
    });
  };
  return (
    <Section
      title="Import modal data"
      note="Nastran .op2, .f06, .pch, .op4, .bdf with its includes; universal files .uff, .unv; one set per fuel weight. Frequency responses or time data of a ground vibration test: .uff, .csv, .mat, .h5, .npz"
    >
      <div
        className="drop-zone"
        onDragOver={(event) => {
          event.preventDefault();
        }}
        onDrop={(event) => {
          event.preventDefault();
          take([...event.dataTransfer.files]);
        }}
      >
        <input
          ref={chooser}
          type="file"
          multiple
          hidden
          aria-label="Modal data files"
          data-testid="structure-files"
          onChange={(event) => {
            take([...(event.currentTarget.files ?? [])]);
            event.currentTarget.value = "";
          }}
        />
        <Group justify="center">
          <Button loading={send.isPending} onClick={() => chooser.current?.click()}>
            Select files
          </Button>
        </Group>
      </div>
      {send.isError && <ProblemAlert error={send.error} />}
    </Section>
  );
}

interface FoundProps {
  id: string;
  aircraft: Aircraft;
  onChange: Props["onChange"];
}

function Found({ id, aircraft, fuel, onChange }: FoundProps & { fuel: number }) {
  const found = useQuery(structureUploadQuery(id));
  return (
    <Loaded query={found} rows={6}>
      {(data) => (
        <Section
          title="File contents"
          note={
            data.frequencies_hz.length > 0 &&
            `${String(data.n_nodes)} nodes; ${data.frequencies_hz
              .slice(0, 14)
              .map((hz) => fixed(hz, 2))
              .join(", ")} Hz`
          }
        >
          <Stack gap="md">
            <DataTable
              label="Files"
              columns={[
                { key: "name", header: "File", render: (row) => row.name },
                { key: "holds", header: "Contents", render: (row) => row.holds.join(", ") },
                { key: "refused", header: "Not used", render: (row) => row.refused.join("; ") },
              ]}
              rows={data.files}
              rowKey={(row) => row.name}
            />
            {data.files.some((file) => file.has_modes) && (
              <ModesForm id={id} found={data} aircraft={aircraft} onChange={onChange} />
            )}
            {data.files.some((file) => file.has_responses || file.has_records) && (
              <ResponsesForm id={id} found={data} aircraft={aircraft} onChange={onChange} />
            )}
            {data.files.some((file) => file.mass !== null) && (
              <MassForm id={id} found={data} aircraft={aircraft} />
            )}
            {data.files.some((file) => file.matrices.length > 0) && (
              <OrthogonalityForm {...{ id, aircraft, fuel, onChange }} found={data} />
            )}
            {data.files.some((file) => file.holds.includes("a flutter summary")) && (
              <FlutterSummaryForm id={id} aircraft={aircraft} onChange={onChange} />
            )}
          </Stack>
        </Section>
      )}
    </Loaded>
  );
}

const AXES = ["aft right up", "forward right down", "forward left up"] as const;
const LENGTHS = ["m", "mm", "in", "ft"] as const;

function ModesForm({ id, found, aircraft, onChange }: FoundProps & { found: StructureFound }) {
  const save = useImportStructure(id, aircraft.id);
  const [name, setName] = useState("FEM");
  const [kind, setKind] = useState<"FEM" | "GVT">("FEM");
  const [axes, setAxes] = useState("aft right up");
  const [rigid, setRigid] = useState(false);
  const [entries, setEntries] = useState<Record<string, string>>({});
  const [fuel, setFuel] = useState<Record<string, number>>({});
  const [analyses, setAnalyses] = useState<Record<string, string>>({});
  const results = found.files.filter((file) => file.has_modes);
  const several = results.filter((file) => file.analyses.length > 1);
  const open = found.queries.filter(
    (missing) => !(missing.field === "mass_unit" && entries.generalized_mass === "unknown"),
  );
  return (
    <Stack gap="sm">
      <Group align="end">
        <TextInput
          label="Name"
          description="The same name creates a new version"
          value={name}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <Select
          label="Kind"
          allowDeselect={false}
          data={["FEM", "GVT"]}
          value={kind}
          onChange={(value) => {
            setKind(value === "GVT" ? "GVT" : "FEM");
          }}
        />
        <Select
          label="Axes x, y, z of the files"
          allowDeselect={false}
          data={[...AXES]}
          value={axes}
          onChange={(value) => {
            setAxes(value ?? axes);
          }}
        />
        <Switch
          label="Include rigid-body modes"
          checked={rigid}
          onChange={(event) => {
            setRigid(event.currentTarget.checked);
          }}
        />
      </Group>
      <Group align="end">
        {open.map((missing) => (
          <Select
            key={missing.field}
            label={missing.text}
            data={[...missing.choices]}
            value={entries[missing.field] ?? null}
            data-testid={`response-${missing.field}`}
            onChange={(value) => {
              setEntries((before) => ({ ...before, [missing.field]: value ?? "" }));
            }}
          />
        ))}
      </Group>
      {several.map((file) => (
        <Select
          key={file.name}
          label={`Modal analysis of ${file.name}`}
          description="Subcase with its label; damping is given for complex modes"
          allowDeselect={false}
          data-testid={`analysis-${file.name}`}
          data={file.analyses.map((one) => ({
            value: one.label,
            label: `${one.label}: ${String(one.n_modes)} modes, ${fixed(one.lowest_hz, 2)} to ${fixed(one.highest_hz, 2)} Hz`,
          }))}
          value={analyses[file.name] ?? file.analyses[0]?.label ?? null}
          onChange={(value) => {
            if (value !== null) setAnalyses((before) => ({ ...before, [file.name]: value }));
          }}
        />
      ))}
      {results.length > 1 && (
        <Group>
          <FuelInputs files={results} fuel={fuel} onChange={setFuel} />
        </Group>
      )}
      {save.isError && <ProblemAlert error={save.error} />}
      <Group>
        <Button
          loading={save.isPending}
          disabled={name.trim() === "" || open.some((missing) => !entries[missing.field])}
          onClick={() => {
            save.mutate(
              { name: name.trim(), kind, axes, rigid_modes: rigid, fuel, analyses, ...entries },
              {
                onSuccess: (table) => {
                  onChange({ table: table.id, tab: "fuel", upload: undefined, mode: undefined });
                },
              },
            );
          }}
        >
          Save modes
        </Button>
      </Group>
    </Stack>
  );
}

const MASSES = ["kg", "t", "lb", "slug", "slinch"] as const;

/** Mass properties of printouts, for the aircraft. */
function MassForm({
  id,
  found,
  aircraft,
}: Omit<FoundProps, "onChange"> & { found: StructureFound }) {
  const save = useImportMassProperties(id, aircraft.id);
  const [length, setLength] = useState<(typeof LENGTHS)[number] | null>(null);
  const [mass, setMass] = useState<(typeof MASSES)[number] | null>(null);
  const [axes, setAxes] = useState("aft right up");
  const [fuel, setFuel] = useState<Record<string, number>>({});
  const files = found.files.filter((file) => file.mass !== null);
  return (
    <Stack gap="xs">
      <Group align="end">
        <Select
          label="Mass unit of the printout"
          description={files.map((file) => `${file.name}: ${fixed(file.mass, 4)}`).join(", ")}
          data={[...MASSES]}
          value={mass}
          onChange={(value) => {
            setMass(MASSES.find((one) => one === value) ?? null);
          }}
        />
        <Select
          label="Length unit of the printout"
          data={[...LENGTHS]}
          value={length}
          onChange={(value) => {
            setLength(LENGTHS.find((one) => one === value) ?? null);
          }}
        />
        <Select
          label="Axes x, y, z of the masses"
          allowDeselect={false}
          data={[...AXES]}
          value={axes}
          onChange={(value) => {
            setAxes(value ?? axes);
          }}
        />
        <FuelInputs files={files} fuel={fuel} onChange={setFuel} />
        <Button
          variant="default"
          disabled={mass === null || length === null}
          loading={save.isPending}
          onClick={() => {
            if (mass !== null && length !== null)
              save.mutate({ mass_unit: mass, length_unit: length, axes, fuel });
          }}
        >
          Use mass properties for the aircraft
        </Button>
      </Group>
      {save.isError && <ProblemAlert error={save.error} />}
      {save.data !== undefined && (
        <Text size="sm" role="status">
          {`Mass properties of ${save.data.name}: ${save.data.mass.mass_kg
            .map(
              (value, row) =>
                `${percent(save.data.mass.fuel[row])} % fuel ${fixed(value, 3)} kg, x c.g. ${fixed(save.data.mass.x_cg_m[row], 4)} m, pitch inertia ${fixed(save.data.mass.pitch_inertia_kg_m2[row], 4)} kg m²`,
            )
            .join("; ")}`}
        </Text>
      )}
    </Stack>
  );
}

const SPEEDS = ["m/s", "ft/s", "in/s", "kt", "km/h"] as const;

function FlutterSummaryForm({ id, aircraft, onChange }: FoundProps) {
  const save = useImportFlutterSummary(id, aircraft.id);
  const [name, setName] = useState("SOL 145");
  const [unit, setUnit] = useState<(typeof SPEEDS)[number] | null>(null);
  return (
    <Group align="end">
      <TextInput
        label="Name of the flutter summary"
        value={name}
        onChange={(event) => {
          setName(event.currentTarget.value);
        }}
      />
      <Select
        label="Velocity unit of the flutter summary"
        data={[...SPEEDS]}
        value={unit}
        onChange={(value) => {
          setUnit(SPEEDS.find((one) => one === value) ?? null);
        }}
      />
      <Button
        variant="default"
        disabled={unit === null || name.trim() === ""}
        loading={save.isPending}
        onClick={() => {
          if (unit !== null)
            save.mutate(
              { name: name.trim(), speed_unit: unit },
              {
                onSuccess: (stored) => {
                  onChange({
                    tab: "flutter",
                    summary: stored.id,
                    analysis: undefined,
                    upload: undefined,
                  });
                },
              },
            );
        }}
      >
        Save flutter summary
      </Button>
      {save.isError && <ProblemAlert error={save.error} />}
    </Group>
  );
}

interface FuelInputsProps {
  files: { name: string }[];
  fuel: Record<string, number>;
  onChange: (fuel: Record<string, number>) => void;
}

/** Fuel fraction of each file, typed in percent. */
function FuelInputs({ files, fuel, onChange }: FuelInputsProps) {
  return files.map((file) => (
    <NumberField
      key={file.name}
      label={`Fuel of ${file.name} [%]`}
      min={0}
      max={100}
      value={100 * (fuel[file.name] ?? 0)}
      onChange={(value) => {
        if (value !== undefined) onChange({ ...fuel, [file.name]: value / 100 });
      }}
    />
  ));
}
