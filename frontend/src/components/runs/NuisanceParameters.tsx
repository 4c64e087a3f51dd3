import { Accordion, Text } from "@mantine/core";
import type { Run } from "../../api/types";
import { fixed, withError } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DerivativeName } from "../display/DerivativeName";
import { Sentence } from "../display/Quantity";

type Retained = NonNullable<Run["retained"]>;
type Nuisance = Retained["parameters"][number];

const COLUMNS: Column<Nuisance>[] = [
  { key: "name", header: "Parameter", render: (one) => <DerivativeName name={one.name} /> },
  numeric("prior", "Prior", (one) => withError(one.prior, one.prior_std).value),
  numeric("prior-std", "σ of the prior", (one) => withError(one.prior, one.prior_std).error),
  numeric("value", "Estimate", (one) => withError(one.value, one.std_error).value),
  numeric("std-error", "σ", (one) => withError(one.value, one.std_error).error),
  {
    key: "change",
    header: "Change",
    unit: "σ of the prior",
    numeric: true,
    render: (one) => fixed((one.value - one.prior) / one.prior_std, 1),
  },
];

interface Props {
  retained: Retained;
  /** Why the run has the modes that it estimates. */
  reasons: readonly string[];
}

/** Prior and estimate of the derivatives of retained modes, which are no results. */
export function NuisanceParameters({ retained, reasons }: Props) {
  return (
    <Accordion variant="contained" className="panel" bg="var(--page-surface)" mt="md" order={2}>
      <Accordion.Item value="nuisance">
        <Accordion.Control data-testid="nuisance">
          Nuisance parameters: {retained.parameters.length} derivatives of modes{" "}
          {retained.modes.join(", ")}
        </Accordion.Control>
        <Accordion.Panel>
          <Text size="sm" mb="sm">
            The prior is the prediction with a spread of {fixed(100 * retained.spread, 0)} %, which
            was estimated from the derivatives of the modes in the band, or the posterior that was
            written back into the prediction. These values are no results; their uncertainty is part
            of every σ.
          </Text>
          {reasons.length > 0 && (
            <Text size="sm" mb="sm" data-testid="nuisance-reasons">
              <Sentence text={reasons.join(" ")} />
            </Text>
          )}
          <DataTable
            label="Nuisance parameters"
            columns={COLUMNS}
            rows={retained.parameters}
            rowKey={(one) => one.name}
            maxHeight={480}
          />
        </Accordion.Panel>
      </Accordion.Item>
    </Accordion>
  );
}
