import { Button, Group, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { useState } from "react";
import { useSaveGlobalModelVersion } from "../../api/commands";
import { globalModelVersionsQuery, type GlobalModelParams } from "../../api/queries";
import type { ReviewedGlobalModel } from "../../api/types";
import { dateTime } from "../../lib/text/format";
import { DataTable, numeric, type Column } from "../controls/DataTable";
import { DecisionBadge } from "../decisions/DecisionBadge";
import { Empty } from "../display/Empty";
import { Loaded } from "../display/Loaded";
import { ProblemAlert } from "../display/ProblemAlert";
import { Section } from "../display/Section";

/** Stored versions of global models; with a computed model, a form that stores it. */
export function GlobalModelVersions({ query }: { query?: GlobalModelParams }) {
  const versions = useQuery(globalModelVersionsQuery());
  return (
    <Section
      title="Versions"
      note="The approved version is the default of flutter, closed loop and priors"
    >
      {query !== undefined && <StoreForm query={query} />}
      <Loaded query={versions} rows={2}>
        {(items) =>
          items.length === 0 ? (
            <Empty title="No versions yet">
              Store a computed global model as a version, and propose it for approval.
            </Empty>
          ) : (
            <DataTable
              label="Versions of global models"
              testId="global-model-versions"
              columns={COLUMNS}
              rows={items}
              rowKey={(row) => row.id}
            />
          )
        }
      </Loaded>
    </Section>
  );
}

function StoreForm({ query }: { query: GlobalModelParams }) {
  const [label, setLabel] = useState("");
  const save = useSaveGlobalModelVersion();
  const navigate = useNavigate();
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        save.mutate(
          { query, request: { label, note: "" } },
          {
            onSuccess: ({ id }) =>
              void navigate({ to: "/global-model/$id", params: { id }, search: {} }),
          },
        );
      }}
    >
      <Group gap="sm" align="end" mb="sm">
        <TextInput
          label="Label of the version"
          required
          maxLength={200}
          value={label}
          onChange={(event) => {
            setLabel(event.currentTarget.value);
          }}
        />
        <Button type="submit" loading={save.isPending} data-testid="store-version">
          Store version
        </Button>
      </Group>
      {save.error !== null && <ProblemAlert error={save.error} />}
    </form>
  );
}

const COLUMNS: Column<ReviewedGlobalModel>[] = [
  numeric("version", "Version", (row) => row.version),
  {
    key: "label",
    header: "Label",
    render: (row) => (
      <Link to="/global-model/$id" params={{ id: row.id }} className="link">
        {row.label}
      </Link>
    ),
  },
  {
    key: "state",
    header: "State",
    render: (row) => (row.state === null ? "not proposed" : <DecisionBadge state={row.state} />),
  },
  { key: "axis", header: "Axis", render: (row) => row.axis },
  numeric("runs", "Runs", (row) => row.runs.length),
  { key: "by", header: "By", render: (row) => row.author || "–" },
  numeric("stored", "Stored", (row) => dateTime(row.created_at)),
];
