import { Alert, Button, Paper, Stack, Text, TextInput, Title } from "@mantine/core";
import { useDocumentTitle } from "@mantine/hooks";
import { useState, type ReactNode, type SubmitEvent } from "react";
import { useAcceptInvitation, useLogIn } from "../../api/commands";
import { NewPassword, PasswordField } from "./NewPassword";
import { ProblemAlert } from "../display/ProblemAlert";

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
          <PasswordField
            label="Password"
            autoComplete="current-password"
            value={password}
            onChange={setPassword}
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

/** Sets the password of an invited account; the code is in the fragment of the address. */
export function InvitationForm() {
  const accept = useAcceptInvitation();
  const code = window.location.hash.slice(1);
  return (
    <Entrance title="Set your password">
      <NewPassword
        label="Password"
        action="Set password"
        focused
        pending={accept.isPending}
        onSubmit={(password) => {
          accept.mutate(
            { code, password },
            {
              onSuccess: () => {
                window.location.assign("/");
              },
            },
          );
        }}
      >
        {accept.isError && <ProblemAlert error={accept.error} />}
      </NewPassword>
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
