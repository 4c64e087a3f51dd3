import { Alert, Button, Paper, PasswordInput, Stack, Text, TextInput, Title } from "@mantine/core";
import { useDocumentTitle } from "@mantine/hooks";
import { useState, type ReactNode, type SubmitEvent } from "react";
import { useAcceptInvitation, useLogIn } from "../api/commands";
import { ProblemAlert } from "./ProblemAlert";

/** Log-in by name and password; in an organisation the proxy has to name the user. */
export function LoginForm({ byPassword }: { byPassword: boolean }) {
  const [name, setName] = useState("");
  const [password, setPassword] = useState("");
  const logIn = useLogIn();
  if (!byPassword) {
    return (
      <Entrance title="No account">
        <Text size="sm">
          Your organisation has not named a user with an account on this server. Ask an
          administrator for one, then reload this page.
        </Text>
      </Entrance>
    );
  }
  const submit = (event: SubmitEvent) => {
    event.preventDefault();
    logIn.mutate({ name, password });
  };
  return (
    <Entrance title="Log in">
      <form onSubmit={submit}>
        <Stack gap="sm">
          <TextInput
            label="Name"
            autoComplete="username"
            data-autofocus
            autoFocus
            required
            value={name}
            onChange={(event) => {
              setName(event.currentTarget.value);
            }}
          />
          <PasswordInput
            label="Password"
            autoComplete="current-password"
            required
            value={password}
            onChange={(event) => {
              setPassword(event.currentTarget.value);
            }}
          />
          {logIn.isError && <ProblemAlert error={logIn.error} />}
          <Button type="submit" loading={logIn.isPending} data-testid="log-in">
            Log in
          </Button>
        </Stack>
      </form>
    </Entrance>
  );
}

/** Log-in at the OpenID provider; the server returns a refusal in the fragment of the address. */
export function ProviderLogin() {
  const refusal = new URLSearchParams(window.location.hash.slice(1)).get("detail");
  return (
    <Entrance title="Log in">
      <Stack gap="sm">
        {refusal !== null && (
          <Alert color="red" title="Not logged in" role="alert">
            {refusal}
          </Alert>
        )}
        <Button component="a" href="/api/v1/session/openid" data-testid="log-in-provider">
          Log in with your organisation
        </Button>
      </Stack>
    </Entrance>
  );
}

const SHORTEST = 12;

/** Sets the password of an invited account; the code is in the fragment of the address. */
export function InvitationForm() {
  const [password, setPassword] = useState("");
  const [again, setAgain] = useState("");
  const accept = useAcceptInvitation();
  const code = window.location.hash.slice(1);
  const differs = again !== "" && again !== password;
  const submit = (event: SubmitEvent) => {
    event.preventDefault();
    accept.mutate(
      { code, password },
      {
        onSuccess: () => {
          window.location.assign("/");
        },
      },
    );
  };
  return (
    <Entrance title="Set your password">
      <form onSubmit={submit}>
        <Stack gap="sm">
          <PasswordInput
            label="Password"
            description={`At least ${String(SHORTEST)} characters`}
            autoComplete="new-password"
            autoFocus
            required
            minLength={SHORTEST}
            value={password}
            onChange={(event) => {
              setPassword(event.currentTarget.value);
            }}
          />
          <PasswordInput
            label="Repeat password"
            autoComplete="new-password"
            required
            error={differs && "The passwords differ"}
            value={again}
            onChange={(event) => {
              setAgain(event.currentTarget.value);
            }}
          />
          {accept.isError && <ProblemAlert error={accept.error} />}
          <Button
            type="submit"
            loading={accept.isPending}
            disabled={again !== password}
            data-testid="set-password"
          >
            Set password
          </Button>
        </Stack>
      </form>
    </Entrance>
  );
}

function Entrance({ title, children }: { title: string; children: ReactNode }) {
  useDocumentTitle(`${title} · flexsid`);
  return (
    <main className="entrance">
      <Paper withBorder p="lg" w={360} maw="100%">
        <Text fw={700} mb="xs">
          flexsid
        </Text>
        <Title order={1} mb="md">
          {title}
        </Title>
        {children}
      </Paper>
    </main>
  );
}
