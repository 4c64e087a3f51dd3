import { Button, Group, NumberInput, Select, Stack, Switch, Text, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useRef, useState } from "react";
import {
  useImportFlutterSummary,
  useImportResponses,
  useImportStructure,
  useUploadFiles,
} from "../../api/commands";
import { flutterSummariesQuery, structureUploadQuery } from "../../api/queries";
import type { Aircraft, FlutterSummary, StructureFound } from "../../api/types";
import { fixed } from "../../lib/format";
import type { StructuresView } from "../../views";
import { DataTable } from "../DataTable";
import { Loaded } from "../Loaded";
import { Notes } from "./Notes";
import { ProblemAlert } from "../ProblemAlert";
import { Section } from "../Section";

interface Props {
  aircraft: Aircraft;
  view: StructuresView;
  onChange: (change: Partial<StructuresView>) => void;
}

/** Files of a structure: dropped, looked at, asked about, and kept as a version. */
export function StructureFiles({ aircraft, view, onChange }: Props) {
  return (
    <Stack gap="md">
      <Choose onChange={onChange} />
      {view.upload !== undefined && (
        <Found key={view.upload} id={view.upload} aircraft={aircraft} onChange={onChange} />
      )}
      <Summaries aircraftId={aircraft.id} />
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
      title="Files of a structure"
      note="Nastran .op2, .f06, .pch, .bdf with what it includes; universal files .uff, .unv; one set per fuel weight if there are several"
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
          aria-label="Files of a structure"
          data-testid="structure-files"
          onChange={(event) => {
            take([...(event.currentTarget.files ?? [])]);
            event.currentTarget.value = "";
          }}
        />
        <Group justify="center">
          <Button loading={send.isPending} onClick={() => chooser.current?.click()}>
            Choose files
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

function Found({ id, aircraft, onChange }: FoundProps) {
  const found = useQuery(structureUploadQuery(id));
  return (
    <Loaded query={found} rows={6}>
      {(data) => (
        <Section
          title="What the files hold"
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
                { key: "holds", header: "Holds", render: (row) => row.holds.join(", ") },
                { key: "refused", header: "Not used", render: (row) => row.refused.join("; ") },
              ]}
              rows={data.files}
              rowKey={(row) => row.name}
            />
            {data.files.some((file) => file.has_modes) && (
              <Questions id={id} found={data} aircraft={aircraft} onChange={onChange} />
            )}
            {data.files.some((file) => file.holds.some((what) => what.endsWith("responses"))) && (
              <ResponsesForm id={id} found={data} aircraft={aircraft} onChange={onChange} />
            )}
            {data.files.some((file) => file.holds.includes("a flutter summary")) && (
              <FlutterSummaryForm id={id} aircraft={aircraft} />
            )}
          </Stack>
        </Section>
      )}
    </Loaded>
  );
}

function Questions({ id, found, aircraft, onChange }: FoundProps & { found: StructureFound }) {
  const keep = useImportStructure(id, aircraft.id);
  const [name, setName] = useState("FEM");
  const [kind, setKind] = useState<"FEM" | "GVT">("FEM");
  const [axes, setAxes] = useState("aft right up");
  const [rigid, setRigid] = useState(false);
  const [answers, setAnswers] = useState<Record<string, string>>({});
  const [fuel, setFuel] = useState<Record<string, number>>({});
  const results = found.files.filter((file) => file.has_modes);
  const open = found.questions.filter(
    (question) => !(question.field === "mass_unit" && answers.generalized_mass === "unknown"),
  );
  return (
    <Stack gap="sm">
      <Group align="end">
        <TextInput
          label="Name"
          description="The same name makes a further version"
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
          label="x, y and z of the files point"
          allowDeselect={false}
          data={["aft right up", "forward right down", "forward left up"]}
          value={axes}
          onChange={(value) => {
            setAxes(value ?? axes);
          }}
        />
        <Switch
          label="Keep rigid-body modes"
          checked={rigid}
          onChange={(event) => {
            setRigid(event.currentTarget.checked);
          }}
        />
      </Group>
      <Group align="end">
        {open.map((question) => (
          <Select
            key={question.field}
            label={question.text}
            data={[...question.choices]}
            value={answers[question.field] ?? null}
            data-testid={`answer-${question.field}`}
            onChange={(value) => {
              setAnswers((before) => ({ ...before, [question.field]: value ?? "" }));
            }}
          />
        ))}
      </Group>
      {results.length > 1 && (
        <Group>
          {results.map((file) => (
            <NumberInput
              key={file.name}
              label={`Fuel of ${file.name} [%]`}
              min={0}
              max={100}
              value={100 * (fuel[file.name] ?? 0)}
              onChange={(value) => {
                if (typeof value === "number")
                  setFuel((before) => ({ ...before, [file.name]: value / 100 }));
              }}
            />
          ))}
        </Group>
      )}
      {keep.isError && <ProblemAlert error={keep.error} />}
      <Group>
        <Button
          loading={keep.isPending}
          disabled={name.trim() === "" || open.some((question) => !answers[question.field])}
          onClick={() => {
            keep.mutate(
              { name: name.trim(), kind, axes, rigid_modes: rigid, fuel, ...answers },
              {
                onSuccess: (table) => {
                  onChange({ table: table.id, tab: "fuel", upload: undefined, mode: undefined });
                },
              },
            );
          }}
        >
          Keep these modes
        </Button>
      </Group>
    </Stack>
  );
}

const RESPONSES = ["m/s2", "g", "in/s2", "ft/s2", "m/s", "in/s", "m", "mm", "in"] as const;
const FORCES = ["N", "lbf"] as const;
const LENGTHS = ["m", "mm", "in", "ft"] as const;

function ResponsesForm({ id, found, aircraft, onChange }: FoundProps & { found: StructureFound }) {
  const keep = useImportResponses(id, aircraft.id);
  const [name, setName] = useState("GVT");
  const [fuel, setFuel] = useState(0);
  const [response, setResponse] = useState<(typeof RESPONSES)[number] | null>(null);
  const [force, setForce] = useState<(typeof FORCES)[number] | null>(null);
  const [length, setLength] = useState<(typeof LENGTHS)[number] | null>(null);
  const asked = found.n_nodes > 0 && found.questions.some((q) => q.field === "length_unit");
  return (
    <Group align="end">
      <TextInput
        label="Name of the test"
        value={name}
        onChange={(event) => {
          setName(event.currentTarget.value);
        }}
      />
      <NumberInput
        label="Fuel [%]"
        w={90}
        min={0}
        max={100}
        value={fuel}
        onChange={(value) => {
          if (typeof value === "number") setFuel(value);
        }}
      />
      <Select
        label="Responses are in"
        w={120}
        data={[...RESPONSES]}
        value={response}
        onChange={(value) => {
          setResponse(RESPONSES.find((one) => one === value) ?? null);
        }}
      />
      <Select
        label="per"
        w={80}
        data={[...FORCES]}
        value={force}
        onChange={(value) => {
          setForce(FORCES.find((one) => one === value) ?? null);
        }}
      />
      {asked && (
        <Select
          label="Geometry in"
          w={90}
          data={[...LENGTHS]}
          value={length}
          onChange={(value) => {
            setLength(LENGTHS.find((one) => one === value) ?? null);
          }}
        />
      )}
      <Button
        variant="default"
        loading={keep.isPending}
        disabled={response === null || force === null || (asked && length === null)}
        onClick={() => {
          if (response !== null && force !== null)
            keep.mutate(
              {
                name,
                response_unit: response,
                force_unit: force,
                fuel: fuel / 100,
                length_unit: length,
              },
              {
                onSuccess: (kept) => {
                  onChange({ tab: "gvt", responses: kept.id, upload: undefined });
                },
              },
            );
        }}
      >
        Keep the responses
      </Button>
      {keep.isError && <ProblemAlert error={keep.error} />}
    </Group>
  );
}

const SPEEDS = ["m/s", "ft/s", "in/s", "kt", "km/h"] as const;

function FlutterSummaryForm({ id, aircraft }: { id: string; aircraft: Aircraft }) {
  const keep = useImportFlutterSummary(id, aircraft.id);
  const [unit, setUnit] = useState<(typeof SPEEDS)[number] | null>(null);
  return (
    <Group align="end">
      <Select
        label="In which unit are the velocities of the flutter summary?"
        data={[...SPEEDS]}
        value={unit}
        onChange={(value) => {
          setUnit(SPEEDS.find((one) => one === value) ?? null);
        }}
      />
      <Button
        variant="default"
        disabled={unit === null}
        loading={keep.isPending}
        onClick={() => {
          if (unit !== null) keep.mutate({ name: "SOL 145", speed_unit: unit });
        }}
      >
        Keep the flutter summary
      </Button>
      {keep.isError && <ProblemAlert error={keep.error} />}
    </Group>
  );
}

function Summaries({ aircraftId }: { aircraftId: number }) {
  const summaries = useQuery(flutterSummariesQuery(aircraftId));
  if (summaries.data === undefined || summaries.data.length === 0) return null;
  return (
    <Section
      title="Flutter summaries"
      note="Speeds where roots lose their damping, of each analysis on its own"
    >
      <DataTable
        label="Flutter summaries"
        testId="flutter-summaries"
        columns={[
          { key: "name", header: "Name", render: (row) => row.name },
          { key: "origin", header: "File", render: (row) => row.origin },
          {
            key: "points",
            header: "Instabilities",
            render: (row) => (
              <Stack gap={4}>
                {row.points.map((point) => (
                  <Text
                    size="sm"
                    key={`${point.analysis} ${String(point.root)} ${String(point.airspeed_m_s)}`}
                  >
                    {instability(point)}
                    {point.analysis !== "" && (
                      <Text span size="xs" c="dimmed">
                        {` ${point.analysis}`}
                      </Text>
                    )}
                  </Text>
                ))}
                {row.points.length === 0 && <Text size="sm">none found</Text>}
              </Stack>
            ),
          },
          { key: "notes", header: "Notes", render: (row) => <Notes notes={row.notes} /> },
        ]}
        rows={summaries.data}
        rowKey={(row) => row.id}
      />
    </Section>
  );
}

/** One root that goes unstable, in words: how, where, and at which frequency. */
function instability(point: FlutterSummary["points"][number]): string {
  const speed = `${fixed(point.airspeed_m_s, 1)} m/s (${fixed(point.airspeed_m_s / 0.514444, 1)} kt)`;
  const where = point.is_bound ? `at or below ${speed}` : speed;
  const frequency = point.kind === "divergence" ? "" : `, ${fixed(point.omega_rad_s, 1)} rad/s`;
  return `root ${String(point.root)}: ${point.kind} ${where}${frequency}`;
}
