import { Accordion, Select, SimpleGrid, Switch, TagsInput } from "@mantine/core";
import { OUT_OF_BAND_MODES, type RunDraft } from "../../lib/drafts/runDraft";
import { number } from "../../lib/urlState";
import { NumberField } from "../controls/NumberField";

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
    draft.outOfBandModes !== "retained" ||
    draft.aerodynamics !== "quasi-steady" ||
    draft.extraParameters.length > 0 ||
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
              description="Prior σ of each free derivative about its prediction, relative to its value; without a selected prediction, mean and σ of the approved global model"
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
            <Select
              label="Out-of-band modes"
              description="Further modes of the modal table; as nuisance parameters their uncertainty is part of σ"
              allowDeselect={false}
              data-testid="run-out-of-band"
              disabled={draft.prediction === null}
              data={[
                { value: "retained", label: "Nuisance parameters" },
                { value: "held", label: "Held at the prediction" },
                { value: "omitted", label: "Omitted" },
              ]}
              value={draft.outOfBandModes}
              onChange={(treatment) => {
                onChange({
                  outOfBandModes: OUT_OF_BAND_MODES.find((one) => one === treatment) ?? "retained",
                });
              }}
            />
            <Select
              size="xs"
              label="Aerodynamics"
              description="Shaped: with the frequency shape of a computed prediction"
              data-testid="run-aerodynamics"
              allowDeselect={false}
              data={[
                { value: "quasi-steady", label: "Quasi-steady" },
                { value: "shaped", label: "Shaped by frequency" },
              ]}
              value={draft.aerodynamics}
              onChange={(value) => {
                onChange({ aerodynamics: value === "shaped" ? "shaped" : "quasi-steady" });
              }}
            />
            <TagsInput
              size="xs"
              label="Extra parameters"
              description="Delays, scale factors, mode frequencies and dampings, e.g. delay_q, omega_7, shape_az_cf_7"
              data-testid="run-extra-parameters"
              placeholder={draft.extraParameters.length === 0 ? "none" : undefined}
              clearable
              limit={40}
              data={offered}
              value={draft.extraParameters}
              onChange={(extraParameters) => {
                onChange({ extraParameters });
              }}
            />
            <NumberField
              label="Maximum iterations"
              description="Convergence usually needs fewer"
              min={1}
              max={1000}
              allowDecimal={false}
              value={draft.maxIterations}
              onChange={(count) => {
                onChange({ maxIterations: count ?? 100 });
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
