{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<header>
<h1>Fleet</h1>
<p class="meta">{{SUMMARY}}</p>
</header>
{{#ROBOTS}}
<section class="card">
<div class="scroll" tabindex="0" role="region" aria-label="Robots">
<table class="list">
<thead><tr><th scope="col">Robot</th><th scope="col">Verdict</th><th scope="col">Calibrated</th><th scope="col">Revision</th><th scope="col">Sessions</th><th scope="col">Edges</th></tr></thead>
<tbody>
{{#ROW}}
<tr><th scope="row"><a href="robots/{{ROBOT}}/">{{ROBOT}}</a></th><td class="text"><span class="badge {{LEVEL}}">{{WORD}}</span> <span class="why" dir="auto">{{WHY}}</span></td><td class="text">{{AGE}}{{#OVERDUE}} <span class="badge fail">overdue</span>{{/OVERDUE}}</td><td>{{#REVISION}}<a href="robots/{{ROBOT}}/revisions/{{NUMBER}}/">{{NUMBER}}</a>{{/REVISION}}{{#NO_REVISION}}none{{/NO_REVISION}}</td><td>{{SESSIONS}}</td><td>{{EDGES}}</td></tr>
{{/ROW}}
</tbody>
</table>
</div>
</section>
{{/ROBOTS}}
{{#EMPTY}}
<section class="card empty">
<h2>No robot has pushed anything yet</h2>
<p>Push a capture session from the machine that has its folder:</p>
<pre><code>rigcal push path/to/session</code></pre>
<p>The robot then appears here by itself, with its sensor graph, its poses and how certain they are. If the push finds no server, this says why:</p>
<pre><code>rigcal doctor</code></pre>
</section>
{{/EMPTY}}
</main>
</body>
</html>
