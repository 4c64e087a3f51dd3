import { Button, Group, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { useChangePassword, useEndAllSessions, useEndSession } from "../api/commands";
import { sessionQuery, sessionsQuery } from "../api/queries";
import type { SessionItem } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { NewPassword, PasswordField } from "../components/account/NewPassword";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { dateMinute } from "../lib/text/format";

/** Password and sessions of the account; a personal server has no accounts. */
export function AccountPage() {
  const session = useQuery(sessionQuery);
  return (
    <>
      <PageHead title="Account" />
      <Loaded query={session}>
        {({ mode }) =>
          mode === "personal" ? (
            <Empty title="No accounts">This server is used in personal mode, without log-in.</Empty>
          ) : (
            <div className="stack">
              {mode === "team" && (
                <Section title="Password">
                  <ChangePassword />
                </Section>
              )}
              <Section title="Sessions" note="Browsers in which you are logged in">
                <Sessions />
              </Section>
            </div>
          )
        }
      </Loaded>
    </>
  );
}

function ChangePassword() {
  const [password, setPassword] = useState("");
  const change = useChangePassword();
  return (
    <NewPassword
      label="New password"
      action="Change password"
      pending={change.isPending}
      onSubmit={(chosen, clear) => {
        change.mutate(
          { password, new_password: chosen },
          {
            onSuccess: () => {
              setPassword("");
              clear();
            },
          },
        );
      }}
      first={
        <PasswordField
          label="Present password"
          autoComplete="current-password"
          value={password}
          onChange={setPassword}
        />
      }
    >
      {change.isError && <ProblemAlert error={change.error} />}
      {change.isSuccess && (
        <Text size="sm" role="status">
          The password is changed, and other sessions have ended.
        </Text>
      )}
    </NewPassword>
  );
}

function Sessions() {
  const sessions = useQuery(sessionsQuery);
  const end = useEndSession();
  const endAll = useEndAllSessions();
  const columns: Column<SessionItem>[] = [
    { key: "address", header: "Address", render: (one) => one.address, yields: true },
    { key: "began", header: "Log-in", render: (one) => dateMinute(one.created_at) },
    { key: "used", header: "Last used", render: (one) => dateMinute(one.used_at) },
    { key: "ends", header: "Ends", render: (one) => dateMinute(one.expires_at) },
    {
      key: "end",
      header: "",
      render: (one) =>
        one.is_current ? (
          "This session"
        ) : (
          <Button
            variant="subtle"
            size="compact-sm"
            color="red"
            aria-label={`End the session from ${one.address}`}
            onClick={() => {
              end.mutate(one.id);
            }}
          >
            End
          </Button>
        ),
    },
  ];
  return (
    <Loaded query={sessions}>
      {(all) =>
        all.length === 0 ? (
          <Empty title="No sessions">Your organisation logs you in.</Empty>
        ) : (
          <>
            <DataTable
              label="Sessions"
              columns={columns}
              rows={all}
              rowKey={(one) => one.id}
              testId="sessions"
            />
            <Group mt="sm">
              <Button
                variant="default"
                loading={endAll.isPending}
                onClick={() => {
                  endAll.mutate();
                }}
                data-testid="log-out-everywhere"
              >
                Log out everywhere
              </Button>
            </Group>
            {(end.error ?? endAll.error) !== null && (
              <ProblemAlert error={end.error ?? endAll.error} />
            )}
          </>
        )
      }
    </Loaded>
  );
}
