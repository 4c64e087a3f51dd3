import { SegmentedControl, Stack } from "@mantine/core";
import { fitsCoefficients, type Run } from "../../api/types";
import { bandOf, overFrequency, windowOf } from "../../lib/figures/band";
import type { RunView } from "../../views";
import { BandBar } from "../maneuvers/BandBar";
import { Empty } from "../display/Empty";
import { Figure } from "../figures/Figure";
import { FitTable } from "./FitTable";

export interface RunTabProps {
  run: Run;
  view: RunView;
  onChange: (change: Partial<RunView>) => void;
}

/** Data and model over frequency, output by output. */
export function FitTab({ run, view, onChange }: RunTabProps) {
  const block = run.blocks.find((one) => one.name === view.block) ?? run.blocks[0];
  if (block === undefined || run.fit === null) return <Empty title="No fit stored" />;
  const output = block.outputs.find((one) => one === view.output) ?? block.outputs[0];
  const { quality, r_squared: overall } = run.fit;
  const own = Object.fromEntries(
    block.outputs.map((name) => {
      const here = quality.find((one) => one.block === block.name && one.output === name);
      return [name, here?.r_squared ?? overall[name] ?? NaN];
    }),
  );
  return (
    <div className="split split-wide">
      <Stack gap="sm">
        <BlockPicker run={run} view={view} onChange={onChange} />
        <div className="panel">
          <FitTable
            values={own}
            quality={quality.filter((one) => one.block === block.name)}
            selected={output}
            onSelect={(name) => {
              onChange({ output: name });
            }}
          />
        </div>
      </Stack>
      <div className="panel" style={{ padding: 12 }}>
        <BandBar
          maneuverId={run.maneuver_id}
          template={run.id}
          window={windowOf(view)}
          onClear={() => {
            onChange(bandOf(null));
          }}
        />
        <Figure
          kind="fit"
          title={`Fit of ${output ?? block.name}`}
          params={{ run_id: run.id, block: block.name, output }}
          {...overFrequency(view, onChange)}
        />
      </div>
    </div>
  );
}

/** Data sets fitted separately: FRE has one per input, EE one per coefficient. */
export function BlockPicker({ run, view, onChange }: RunTabProps) {
  if (run.blocks.length < 2) return null;
  return (
    <SegmentedControl
      aria-label={fitsCoefficients(run) ? "Coefficient" : "Input"}
      data={run.blocks.map((block) => block.name)}
      value={view.block ?? run.blocks[0]?.name}
      style={{ alignSelf: "flex-start", maxWidth: "100%", overflowX: "auto" }}
      onChange={(block) => {
        onChange({ block });
      }}
    />
  );
}
