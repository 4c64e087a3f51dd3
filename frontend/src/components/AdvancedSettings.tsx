import { Accordion, NumberInput, Select, SimpleGrid, Switch, TagsInput } from "@mantine/core";
import type { RunDraft } from "../lib/runDraft";
import { integer, number } from "../lib/urlState";

const SPREADS = [
  { value: "none", label: "None" },
  { value: "0.25", label: "25 %" },
  { value: "0.5", label: "50 %" },
  { value: "1", label: "100 %" },
];

interface Props {
  draft: RunDraft;
  outputs: readonly string[];
  onChange: (part: Partial<RunDraft>) => void;
}

/** Settings that most runs leave at their defaults. */
export function AdvancedSettings({ draft, outputs, onChange }: Props) {
  const spread = draft.priorSpread === null ? "none" : String(draft.priorSpread);
  const spreads = SPREADS.some((one) => one.value === spread)
    ? SPREADS
    : [...SPREADS, { value: spread, label: `${100 * Number(spread)} %` }];
  const offered = [
    ...outputs.flatMap((name) => [`delay_${name}`, `scale_${name}`]),
    ...draft.modes.flatMap((mode) => [`omega_${mode}`, `zeta_${mode}`]),
  ];
  const changed =
    draft.freeDelays ||
    draft.outOfBandModes ||
    draft.alsoFree.length > 0 ||
    draft.noise === "full" ||
    draft.priorSpread !== null;
  return (
    <Accordion
      variant="contained"
      className="panel"
      bg="var(--page-surface)"
      order={2}
      defaultValue={changed ? "advanced" : null}
      data-testid="advanced"
    >
      <Accordion.Item value="advanced">
        <Accordion.Control>Priors, noise and extra parameters</Accordion.Control>
        <Accordion.Panel>
          <SimpleGrid cols={{ base: 1, sm: 2 }} spacing="md">
            <Select
              label="Prior spread"
              description="Prior σ of each free derivative about its prediction, relative to its value"
              allowDeselect={false}
              data-testid="run-prior"
              data={spreads}
              value={spread}
              onChange={(share) => {
                onChange({ priorSpread: number(share) ?? null });
              }}
            />
            <Select
              label="Noise"
              description="Correlation of the residuals between outputs"
              allowDeselect={false}
              data-testid="run-noise"
              data={[
                { value: "diagonal", label: "Outputs independent" },
                { value: "full", label: "Outputs correlated" },
              ]}
              value={draft.noise}
              onChange={(noise) => {
                onChange({ noise: noise === "full" ? "full" : "diagonal" });
              }}
            />
            <Switch
              label="Include out-of-band modes"
              description="With the derivatives of the prediction; recommended for flutter prediction"
              data-testid="run-out-of-band"
              disabled={draft.prediction === null}
              checked={draft.outOfBandModes}
              onChange={(event) => {
                onChange({ outOfBandModes: event.currentTarget.checked });
              }}
            />
            <TagsInput
              size="xs"
              label="Extra parameters"
              description="Delays, scale factors, mode frequencies and dampings, e.g. delay_q, omega_7, shape_az_cf_7"
              data-testid="run-also-free"
              placeholder={draft.alsoFree.length === 0 ? "none" : undefined}
              clearable
              limit={40}
              data={offered}
              value={draft.alsoFree}
              onChange={(alsoFree) => {
                onChange({ alsoFree });
              }}
            />
            <NumberInput
              label="Maximum iterations"
              description="Convergence usually needs fewer"
              min={1}
              max={1000}
              allowDecimal={false}
              value={draft.maxIterations}
              onChange={(count) => {
                onChange({ maxIterations: integer(count) ?? 100 });
              }}
            />
            <Switch
              label="Free time delays"
              description="One time delay per output"
              checked={draft.freeDelays}
              onChange={(event) => {
                onChange({ freeDelays: event.currentTarget.checked });
              }}
            />
          </SimpleGrid>
        </Accordion.Panel>
      </Accordion.Item>
    </Accordion>
  );
}
