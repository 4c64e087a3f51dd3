import { Alert, Button, Code, CopyButton, Group, Select, TextInput } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState, type SubmitEvent } from "react";
import { useCreateToken, useDeleteToken } from "../api/commands";
import { aircraftQuery, sessionQuery, tokensQuery } from "../api/queries";
import { ROLES } from "../api/roles";
import type { Role, Token } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { NumberField } from "../components/controls/NumberField";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { dateMinute } from "../lib/text/format";

/** API tokens of the account; a personal server has no accounts. */
export function TokensPage() {
  const session = useQuery(sessionQuery);
  return (
    <Loaded query={session}>
      {({ mode }) =>
        mode === "personal" ? (
          <>
            <PageHead title="API tokens" />
            <Empty title="No accounts">
              This server is used in personal mode: scripts need no token.
            </Empty>
          </>
        ) : (
          <Tokens />
        )
      }
    </Loaded>
  );
}

function Tokens() {
  const tokens = useQuery(tokensQuery);
  const aircraft = useQuery(aircraftQuery);
  const remove = useDeleteToken();
  const nameOf = (id: number | null) =>
    id === null ? "All" : (aircraft.data?.find((one) => one.id === id)?.name ?? String(id));
  const columns: Column<Token>[] = [
    { key: "name", header: "Name", render: (token) => token.name, yields: true },
    { key: "role", header: "Highest role", render: (token) => token.role },
    { key: "campaign", header: "Campaign", render: (token) => nameOf(token.aircraft_id) },
    { key: "expires", header: "Expires", render: (token) => dateMinute(token.expires_at) },
    {
      key: "used",
      header: "Last used",
      render: (token) => (token.used_at === null ? "–" : dateMinute(token.used_at)),
    },
    {
      key: "delete",
      header: "",
      render: (token) => (
        <Button
          variant="subtle"
          size="compact-sm"
          color="red"
          aria-label={`Delete token ${token.name}`}
          onClick={() => {
            remove.mutate(token.id);
          }}
        >
          Delete
        </Button>
      ),
    },
  ];
  return (
    <>
      <PageHead title="API tokens" />
      <div className="stack">
        <Section title="New token" note="For scripts and notebooks, which act in your name">
          <NewToken
            campaigns={(aircraft.data ?? []).map(({ id, name }) => ({
              value: String(id),
              label: name,
            }))}
          />
        </Section>
        <Section title="Tokens">
          <Loaded query={tokens}>
            {(all) =>
              all.length === 0 ? (
                <Empty title="No tokens">Create one above.</Empty>
              ) : (
                <DataTable
                  label="API tokens"
                  columns={columns}
                  rows={all}
                  rowKey={(token) => token.id}
                  testId="tokens"
                />
              )
            }
          </Loaded>
        </Section>
      </div>
    </>
  );
}

function NewToken({ campaigns }: { campaigns: { value: string; label: string }[] }) {
  const [name, setName] = useState("");
  const [role, setRole] = useState<Role>("viewer");
  const [days, setDays] = useState(90);
  const [campaign, setCampaign] = useState<string | null>(null);
  const create = useCreateToken();
  const submit = (event: SubmitEvent) => {
    event.preventDefault();
    create.mutate(
      { name: name.trim(), role, days, aircraft_id: campaign === null ? null : Number(campaign) },
      {
        onSuccess: () => {
          setName("");
        },
      },
    );
  };
  return (
    <form onSubmit={submit}>
      <Group align="end" gap="sm">
        <TextInput
          label="Name"
          required
          maxLength={100}
          value={name}
          onChange={(event) => {
            setName(event.currentTarget.value);
          }}
        />
        <Select
          label="Highest role"
          data={ROLES}
          value={role}
          allowDeselect={false}
          onChange={(selected) => {
            setRole(ROLES.find((one) => one === selected) ?? "viewer");
          }}
        />
        <Select
          label="Campaign"
          placeholder="All"
          clearable
          data={campaigns}
          value={campaign}
          onChange={setCampaign}
        />
        <NumberField
          label="Valid for [days]"
          min={1}
          max={366}
          allowDecimal={false}
          value={days}
          onChange={(value) => {
            setDays(value ?? 1);
          }}
        />
        <Button type="submit" loading={create.isPending} data-testid="create-token">
          Create token
        </Button>
      </Group>
      {create.isError && <ProblemAlert error={create.error} />}
      {create.data?.secret != null && (
        <Alert
          mt="md"
          color="teal"
          variant="light"
          title="Copy the token now: it is not shown again"
        >
          <Group gap="sm">
            <Code data-testid="token-secret">{create.data.secret}</Code>
            <CopyButton value={create.data.secret}>
              {({ copied, copy }) => (
                <Button variant="default" size="compact-sm" onClick={copy}>
                  {copied ? "Copied" : "Copy"}
                </Button>
              )}
            </CopyButton>
          </Group>
        </Alert>
      )}
    </form>
  );
}
