import { Checkbox, Group, Select, Stack, Text, TextInput } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { storedResult, type AnalysisQuery } from "../../api/storedResult";
import type { Design, OptimalDesign } from "../../api/types";
import { degrees, fixed } from "../../lib/text/format";
import { OBJECTIVES, type DesignView } from "../../views";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { NumberField } from "../controls/NumberField";

const RADIAN = Math.PI / 180;

const NAMES: Record<(typeof OBJECTIVES)[number], string> = {
  flutter: "Flutter speed",
  derivatives: "Derivatives",
  damping: "Damping of a mode",
  structures: "Distance of two model structures",
};

const QUANTITIES: Record<string, [string, (value: number) => string]> = {
  deflection: ["Deflection [deg]", (value) => fixed(degrees(value), 2)],
  rate: ["Rate [deg/s]", (value) => fixed(degrees(value), 1)],
  load_factor: ["Load factor [g]", (value) => fixed(value, 3)],
};

type Peak = OptimalDesign["limits"][number];

const PEAKS: Column<Peak>[] = [
  { key: "name", header: "Peak", render: (row) => QUANTITIES[row.name]?.[0] ?? row.name },
  ...(["limit", "standard", "optimal"] as const).map((key) => ({
    key,
    header: { limit: "Limit", standard: "Standard", optimal: "Optimal" }[key],
    numeric: true,
    render: (row: Peak) => QUANTITIES[row.name]?.[1](row[key]) ?? "",
  })),
];

interface Props {
  design: Design;
  level: number;
  run: number;
  view: DesignView;
  onChange: (part: Partial<DesignView>) => void;
}

/** Optimal design for one objective within limits, and its gain over this design. */
export function OptimalDesignPart({ design, level, run, view, onChange }: Props) {
  const { objective } = view;
  const request: AnalysisQuery<"/api/v1/designs/{design_id}/optimal-design"> = {
    run_id: run,
    level,
    objective: objective ?? "flutter",
    derivatives: objective === "derivatives" ? view.derivatives : undefined,
    mode: objective === "damping" ? view.mode : undefined,
    other_run_id: objective === "structures" ? view.other : undefined,
    deflection: view.allowed === undefined ? undefined : view.allowed * RADIAN,
    rate: view.fastest === undefined ? undefined : view.fastest * RADIAN,
    load_factor: view.load,
    spread: view.spread === undefined ? undefined : view.spread / 100,
    after_run: view.after,
  };
  const isComplete =
    objective === "flutter" ||
    request.derivatives !== undefined ||
    request.mode !== undefined ||
    request.other_run_id !== undefined;
  const limit = (
    label: string,
    unit: string,
    key: "allowed" | "fastest" | "load" | "spread",
    empty = "limit of the design",
  ) => (
    <NumberField
      label={label}
      unit={unit}
      placeholder={empty}
      isPositive
      w={190}
      value={view[key]}
      onChange={(next) => {
        onChange({ [key]: next });
      }}
    />
  );
  return (
    <Stack gap="sm">
      <Group align="end">
        <Select
          label="Objective"
          placeholder="Select an objective"
          w={250}
          data={OBJECTIVES.map((value) => ({ value, label: NAMES[value] }))}
          value={objective ?? null}
          onChange={(next) => {
            onChange({ objective: OBJECTIVES.find((one) => one === next) });
          }}
        />
        {objective === "derivatives" && (
          <TextInput
            label="Derivatives, separated by commas"
            placeholder="Cm_alpha, Cm_q"
            w={280}
            defaultValue={view.derivatives ?? ""}
            onBlur={(event) => {
              onChange({ derivatives: event.currentTarget.value || undefined });
            }}
          />
        )}
        {objective === "damping" && (
          <TextInput
            label="Root"
            placeholder="SP or a mode number"
            w={190}
            defaultValue={view.mode ?? ""}
            onBlur={(event) => {
              onChange({ mode: event.currentTarget.value || undefined });
            }}
          />
        )}
        {objective === "structures" && (
          <NumberField
            label="Run with the smaller structure"
            min={1}
            allowDecimal={false}
            w={230}
            value={view.other}
            onChange={(other) => {
              onChange({ other });
            }}
          />
        )}
      </Group>
      <Group align="end">
        {limit("Deflection limit", "deg", "allowed")}
        {limit("Rate limit", "deg/s", "fastest")}
        {limit("Load factor limit", "g", "load")}
        {limit("Spread of derivatives", "%", "spread", "exactly as in the run")}
        <Checkbox
          label="Add to the data of the run"
          mb={8}
          checked={view.after === true}
          onChange={(event) => {
            onChange({ after: event.currentTarget.checked || undefined });
          }}
        />
      </Group>
      {isComplete ? (
        <ComputedResult
          options={storedResult("/api/v1/designs/{design_id}/optimal-design", {
            path: { design_id: design.id },
            query: request,
          })}
          rows={4}
        >
          {(result) => <Gain result={result} run={run} />}
        </ComputedResult>
      ) : (
        <Empty title="No objective">
          Select what the maneuver is flown for. The optimal design is stored beside this one.
        </Empty>
      )}
    </Stack>
  );
}

function Gain({ result, run }: { result: OptimalDesign; run: number }) {
  const unit = result.unit === "1" ? "" : ` ${result.unit}`;
  return (
    <>
      <Text size="sm" data-testid="optimal-gain">
        Predicted {result.quantity}: {result.optimal.toPrecision(3)}
        {unit} with the{" "}
        <Link
          to="/excitation/$id"
          params={{ id: result.optimal_design_id }}
          search={{ run, level: 2 }}
          className="link"
        >
          optimal design
        </Link>{" "}
        at its high amplitude, {result.standard.toPrecision(3)}
        {unit} with this design within the same limits
        {result.standard_time_s === null
          ? "."
          : `, which would have to be flown for ${fixed(result.standard_time_s, 0)} s instead of ${fixed(result.duration_s, 0)} s.`}
      </Text>
      <DataTable
        label="Limited quantities"
        testId="optimal-limits"
        columns={PEAKS}
        rows={[...result.limits]}
        rowKey={(row) => row.name}
      />
    </>
  );
}
