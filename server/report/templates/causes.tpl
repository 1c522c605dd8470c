{{%AUTOESCAPE context="HTML"}}
<section class="card causes">
<h2 id="causes" data-part="Causes">Causes <span class="soft">each with one thing to do</span></h2>
<ol>
{{#CAUSE}}
<li>
<p class="why" dir="auto">{{WHY:x-typed}}</p>
<p class="do" dir="auto">{{WHAT_TO_DO:x-typed}}{{#COMMAND}} Then:{{/COMMAND}}</p>
{{#COMMAND}}<pre class="command"><code>{{TEXT}}</code></pre>{{/COMMAND}}
{{#EXPLAINS}}<details class="words"><summary>Explains {{COUNT}}</summary>{{>PAIRS}}</details>{{/EXPLAINS}}
</li>
{{/CAUSE}}
</ol>
</section>
