import { Alert, Button, Group, Text } from "@mantine/core";
import { asProblem } from "../../api/problem";
import { ButtonLink } from "../controls/ButtonLink";

interface Props {
  error: unknown;
  onRetry?: () => void;
}

/** What went wrong, in the server's words, with where it was found and a way on. */
export function ProblemAlert({ error, onRetry }: Props) {
  const problem = asProblem(error);
  const where = Object.entries(problem.context);
  return (
    <Alert color="red" variant="light" title={problem.title} role="alert" data-testid="problem">
      <Text size="sm">{problem.detail}</Text>
      {where.length > 0 && (
        <Text size="sm" mt={4} className="numbers">
          {where.map(([key, value]) => `${key.replaceAll("_", " ")} ${value}`).join(", ")}
        </Text>
      )}
      <Group mt="xs" gap="sm">
        {problem.status === 404 && (
          <ButtonLink to="/" variant="default">
            Start page
          </ButtonLink>
        )}
        {onRetry && problem.status !== 404 && (
          <Button variant="default" onClick={onRetry}>
            Retry
          </Button>
        )}
        {problem.code !== "" && (
          <Text size="xs" className="quiet" component="code">
            {problem.code}
          </Text>
        )}
      </Group>
    </Alert>
  );
}
