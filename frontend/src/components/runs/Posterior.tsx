import { Alert, Button, Stack, Text } from "@mantine/core";
import { useState } from "react";
import { storedResult } from "../../api/storedResult";
import type { PosteriorCheck, Run } from "../../api/types";
import { fixed, withError } from "../../lib/text/format";
import { ComputedResult } from "../display/ComputedResult";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { Empty } from "../display/Empty";
import { Section } from "../display/Section";

type Quantity = PosteriorCheck["parameters"][number];

const COLUMNS: Column<Quantity>[] = [
  {
    key: "name",
    header: "Quantity",
    render: (one) => (one.unit === "" ? one.name : `${one.name} [${one.unit}]`),
  },
  numeric("value", "Value", (one) => withError(one.value, one.std_error).value),
  numeric("std", "σ", (one) => withError(one.value, one.std_error).error),
  numeric("low", "95 % from", (one) => withError(one.low, one.std_error).value),
  numeric("high", "to", (one) => withError(one.high, one.std_error).value),
  numeric(
    "ratio",
    <span title="Standard deviation of the posterior over that to first order">Ratio of σ</span>,
    (one) => `${fixed(one.ratio, 2)} ± ${fixed(one.ratio_error, 2)}`,
  ),
  numeric(
    "scale-reduction",
    <span title="Potential scale reduction of the chains: 1 at convergence">R̂</span>,
    (one) => fixed(one.scale_reduction, 3),
  ),
  numeric(
    "sample-size",
    <span title="Number of independent samples of the same error">Effective samples</span>,
    (one) => fixed(one.sample_size, 0),
  ),
];

/** Whether the standard errors of an output-error run hold beyond first order. */
export function Posterior({ run }: { run: Run }) {
  const [requested, setRequested] = useState(false);
  if (run.method !== "OE") {
    return <Empty title="No posterior check">It applies to runs of output error.</Empty>;
  }
  return (
    <Section
      title="Posterior"
      note="Samples of the posterior by Hamiltonian Monte Carlo, against the standard errors, which are to first order"
    >
      {requested ? (
        <ComputedResult
          options={storedResult("/api/v1/posterior-checks", { query: { run_id: run.id } })}
        >
          {(data) => <Check data={data} />}
        </ComputedResult>
      ) : (
        <Button
          size="xs"
          variant="default"
          data-testid="sample-posterior"
          onClick={() => {
            setRequested(true);
          }}
        >
          Sample posterior
        </Button>
      )}
    </Section>
  );
}

function Check({ data }: { data: PosteriorCheck }) {
  return (
    <Stack gap="sm">
      <Alert
        color={data.is_confirmed ? "green" : "yellow"}
        variant="light"
        role="status"
        data-testid="posterior-check"
      >
        {data.sentence}
      </Alert>
      <Text size="sm">
        {data.n_chains} chains of {data.n_samples} samples, {fixed(100 * data.acceptance, 0)} % of
        the trajectories accepted. Intervals are about the values of the run and in proportion to
        its standard errors.
      </Text>
      <DataTable
        label="Posterior of parameters, poles and the flutter speed"
        columns={COLUMNS}
        rows={[...data.parameters, ...data.poles, ...(data.flutter === null ? [] : [data.flutter])]}
        rowKey={(one) => one.name}
      />
    </Stack>
  );
}
