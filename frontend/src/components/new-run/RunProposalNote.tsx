import { Alert, Text } from "@mantine/core";
import type { RunProposal } from "../../api/types";
import { fixed } from "../../lib/text/format";
import { Band, Quantity, Sentence } from "../display/Quantity";
import { Section } from "../display/Section";

interface Props {
  proposal: RunProposal;
  /** Modes that the form has now. */
  modes: readonly number[];
}

/** Excited band, modes in the band, and data per parameter of the proposed model. */
export function RunProposalNote({ proposal, modes }: Props) {
  const above = proposal.modes.filter((mode) => modes.includes(mode.number) && !mode.in_band);
  return (
    <Section title="Proposal" note={<Band hz={proposal.basis.band_hz} />}>
      <Text size="sm" data-testid="run-proposal">
        <Sentence text={proposal.basis.reasons.join(" ")} /> {proposal.n_parameters} parameters,{" "}
        {proposal.n_lines} excited frequencies, {fixed(proposal.lines_per_parameter, 1)} per
        parameter of an equation,{" "}
        <Quantity value={proposal.resolution_hz} unit="Hz" decimals={3} named /> apart.
      </Text>
      {above.length > 0 && (
        <Alert color="orange" variant="light" mt="sm" data-testid="above-band">
          {above.map((mode) => mode.name).join(", ")} not below the upper limit of the excited band:
          little information on these modes; standard errors may be too small.
        </Alert>
      )}
      {proposal.warnings.map((warning) => (
        <Text size="sm" key={warning}>
          <Sentence text={warning} />
        </Text>
      ))}
    </Section>
  );
}
